#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>

#include "core/error.h"
#include "core/numeric.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "image/motion_file.h"

namespace render2mpeg::fuzz {
namespace {

class Descriptor {
  public:
    explicit Descriptor(const std::filesystem::path& file) : number_(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (number_ < 0) throw std::logic_error("an input that was written cannot be opened");
    }
    ~Descriptor() { close(number_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }

  private:
    int number_;
};

void expect_sound(const core::MotionField& field, std::int64_t picture, std::int64_t reference) {
    if (field.picture != picture || field.reference != reference) throw std::logic_error("motion of other frames");
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        if (!core::is_finite(field.vector.values()[i])) throw std::logic_error("motion to nowhere");
        if (static_cast<int>(field.kind.values()[i]) > 3) throw std::logic_error("a class that there is not");
    }
}

}  // namespace

bool motion(Input input) {
    const Descriptor file(input_file().write("film.motion", input));
    image::MotionBytes bytes(file.number(), "film.motion");
    try {
        const image::MotionHeader header = bytes.header(4, 2);
        image::FrameMotion motion;
        std::size_t frames = 0;
        for (; bytes.frame(header, static_cast<std::int64_t>(frames), motion); ++frames) {
            expect_sound(motion.to_previous, static_cast<std::int64_t>(frames), static_cast<std::int64_t>(frames) - 1);
            expect_sound(motion.to_next, static_cast<std::int64_t>(frames), static_cast<std::int64_t>(frames) + 1);
        }
        const std::size_t frame = 4 * 2 * (sizeof(glm::vec2) * static_cast<std::size_t>(header.fields) + 1);
        if (input.size() != 32 + frames * frame) throw std::logic_error("frames are missing");
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

}  // namespace render2mpeg::fuzz
