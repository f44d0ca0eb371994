#include "image/motion_file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

using Values = const std::vector<float>*;

/// Whether a name is `end`, alone or behind a layer's name and a dot.
bool ends_with(const std::string& name, const std::string& end) {
    return name.ends_with(end) && (name.size() == end.size() || name[name.size() - end.size() - 1] == '.');
}

/// Channels of a file found by the end of their names: "ViewLayer.Vector.X" is "Vector.X" of some layer.
class Layers {
  public:
    explicit Layers(ExrChannels channels) : file_(std::move(channels)) {}

    int width() const { return file_.width; }
    int height() const { return file_.height; }

    /// Two channels of the same layer: the first such pair. Nothing unless both are there.
    std::optional<std::pair<Values, Values>> pair(const std::string& first, const std::string& second) const {
        for (const Channel& channel : file_.channels) {
            if (!ends_with(channel.name, first)) continue;
            const std::string layer = channel.name.substr(0, channel.name.size() - first.size());
            if (const Values other = exact(layer + second)) return std::pair{&channel.values, other};
        }
        return {};
    }
    /// Null where there is none.
    Values exact(const std::string& name) const {
        for (const Channel& channel : file_.channels)
            if (channel.name == name) return &channel.values;
        return nullptr;
    }

  private:
    ExrChannels file_;
};

/// Adds a direction to a field: `scale` times the values are reference minus current position, y up.
void fill(core::MotionField& field, const std::pair<Values, Values>& values, float scale) {
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        const glm::vec2 v{scale * (*values.first)[i], -scale * (*values.second)[i]};
        if (core::is_finite(v))
            field.vector.values()[i] = v;
        else
            field.kind.values()[i] = core::PixelClass::none;
    }
}

/// X and Y: previous minus current. Z and W: current minus next. [BlenderVector]
bool fill_blender(FrameMotion& motion, const Layers& layers) {
    const auto previous = layers.pair("Vector.X", "Vector.Y"), next = layers.pair("Vector.Z", "Vector.W");
    if (!previous || !next) return false;
    fill(motion.to_previous, *previous, 1);
    fill(motion.to_next, *next, -1);
    return true;
}

/// `forward`: next minus current; `backward`: previous minus current; `motion` alone is forward [NukeVectors]. What is
/// missing of both is the other turned round: what moves evenly goes on as it came.
bool fill_nuke(FrameMotion& motion, const Layers& layers) {
    const auto backward = layers.pair("backward.u", "backward.v");
    auto forward = layers.pair("forward.u", "forward.v");
    if (!forward && !backward) forward = layers.pair("motion.u", "motion.v");
    if (!forward && !backward) return false;
    fill(motion.to_previous, backward ? *backward : *forward, backward ? 1.0f : -1.0f);
    fill(motion.to_next, forward ? *forward : *backward, forward ? 1.0f : -1.0f);
    return true;
}

/// Pixel classes, which our own files store beside Vector; other files do not distinguish surfaces from sky.
core::Plane<core::PixelClass> classes(const Layers& layers) {
    core::Plane<core::PixelClass> kinds(layers.width(), layers.height(), core::PixelClass::surface);
    if (const Values values = layers.exact("render2mpeg.Class.X"))
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const float value = (*values)[i];
            kinds.values()[i] = value >= 0.0f && value < 3.5f ? static_cast<core::PixelClass>(std::lround(value))
                                                              : core::PixelClass::none;
        }
    return kinds;
}

std::string sizes_text(std::int64_t width, std::int64_t height, int of_pictures, int height_of_pictures) {
    return "its motion is " + std::to_string(width) + "x" + std::to_string(height) + " pixels, the pictures are " +
           std::to_string(of_pictures) + "x" + std::to_string(height_of_pictures);
}

static_assert(std::endian::native == std::endian::little, "motion streams are little endian, and read as they are");

constexpr std::uint32_t mark = 0x564d3252u;  ///< "R2MV"

/// Of vectors in 16 bits. chosen: 32, a sixteenth of what prediction tells apart, and up to 1,024 pixels.
constexpr float steps_of_a_pixel = 32;
constexpr std::int16_t no_step = std::numeric_limits<std::int16_t>::min();  ///< no motion is known

/// Turns non-finite vectors to `none`, and sets a field's frames.
void settle_field(core::MotionField& field, const core::Plane<core::PixelClass>& kinds, std::int64_t number, int step) {
    field.picture = number;
    field.reference = number + step;
    field.kind = kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (!core::is_finite(field.vector.values()[i])) {
            field.vector.values()[i] = glm::vec2(0);
            field.kind.values()[i] = core::PixelClass::none;
        }
}

}  // namespace

FrameMotion motion_of(const std::filesystem::path& file, ExrChannels channels, std::int64_t frame, int width,
                      int height, MotionConvention convention) {
    const Layers layers(std::move(channels));
    if (layers.width() != width || layers.height() != height)
        throw core::Error("reading", file.string(), sizes_text(layers.width(), layers.height(), width, height));
    FrameMotion motion;
    for (core::MotionField* field : {&motion.to_previous, &motion.to_next}) {
        field->picture = frame;
        field->reference = field == &motion.to_previous ? frame - 1 : frame + 1;
        field->vector = core::Plane<glm::vec2>(width, height, glm::vec2(0));
        field->kind = classes(layers);
    }
    const bool found =
        convention == MotionConvention::blender ? fill_blender(motion, layers) : fill_nuke(motion, layers);
    if (!found)
        throw core::Error("reading", file.string(),
                          convention == MotionConvention::blender
                              ? "it has no motion: Blender's convention has channels Vector.X, .Y, .Z and .W"
                              : "it has no motion: Nuke's convention has channels forward.u and .v, backward.u and .v, "
                                "or motion.u and .v");
    return motion;
}

bool is_motion(const std::string& channel) {
    for (const char* end : {"Vector.X", "Vector.Y", "Vector.Z", "Vector.W", "forward.u", "forward.v", "backward.u",
                            "backward.v", "motion.u", "motion.v", "render2mpeg.Class.X"})
        if (ends_with(channel, end)) return true;
    return false;
}

FrameMotion read_motion(const std::filesystem::path& file, std::int64_t frame, int width, int height,
                        MotionConvention convention) {
    return motion_of(file, read_exr(file, is_motion), frame, width, height, convention);
}

void MotionBytes::refuse(const std::string& cause) const {
    throw core::Error("reading", name_, "byte " + std::to_string(at_), cause);
}

bool MotionBytes::read(void* into, std::size_t size) {
    auto* to = static_cast<std::uint8_t*>(into);
    for (std::size_t done = 0; done < size;) {
        pollfd state{descriptor_, POLLIN, 0};
        if (poll(&state, 1, 100) <= 0) {
            if (stopped_) refuse("nobody wants it any more");
            continue;
        }
        const ssize_t count = ::read(descriptor_, to + done, size - done);
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count < 0) refuse(std::strerror(errno));
        if (count == 0 && done == 0) return false;
        if (count == 0) refuse("it is cut off");
        done += static_cast<std::size_t>(count);
        at_ += static_cast<std::uint64_t>(count);
    }
    return true;
}

MotionHeader MotionBytes::header(int width, int height) {
    std::array<std::uint32_t, 8> words{};
    if (!read(words.data(), sizeof words)) refuse("it is empty");
    at_ = 0;
    if (words[0] != mark) refuse("no motion stream begins here: expected R2MV");
    if (words[1] < 1 || words[1] > 2) refuse("version " + std::to_string(words[1]) + " is not known, only 1 and 2");
    if (words[2] != static_cast<std::uint32_t>(width) || words[3] != static_cast<std::uint32_t>(height))
        refuse(sizes_text(words[2], words[3], width, height));
    if (words[4] < 1 || words[4] > 2) refuse(std::to_string(words[4]) + " fields per frame: expected 1 or 2");
    if (words[5] != 0 || words[6] != 0 || words[7] != 0) refuse("the header's last 12 bytes are not 0");
    at_ = sizeof words;
    return {width, height, static_cast<int>(words[4]), words[1] == 2};
}

bool MotionBytes::vectors(const MotionHeader& header, core::Plane<glm::vec2>& vectors) {
    if (!header.compact) return read(vectors.values().data(), vectors.size() * sizeof(glm::vec2));
    std::vector<std::int16_t> steps(2 * vectors.size());
    if (!read(steps.data(), steps.size() * sizeof(std::int16_t))) return false;
    const auto pixels = [](std::int16_t step) {
        return step == no_step ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(step) / steps_of_a_pixel;
    };
    for (std::size_t i = 0; i < vectors.size(); ++i)
        vectors.values()[i] = {pixels(steps[2 * i]), pixels(steps[2 * i + 1])};
    return true;
}

bool MotionBytes::frame(const MotionHeader& header, std::int64_t number, FrameMotion& motion) {
    core::Plane<glm::vec2>& back = motion.to_previous.vector;
    core::Plane<glm::vec2>& on = motion.to_next.vector;
    back = on = core::Plane<glm::vec2>(header.width, header.height);
    if (!vectors(header, back)) return false;
    if (header.fields == 1) {
        // Even motion goes on as it came.
        for (std::size_t i = 0; i < on.size(); ++i) on.values()[i] = -back.values()[i];
    } else if (!vectors(header, on)) {
        refuse("it is cut off");
    }
    core::Plane<std::uint8_t> codes(header.width, header.height);
    const std::uint64_t begin = at_;
    if (!read(codes.values().data(), codes.size())) refuse("it is cut off");
    core::Plane<core::PixelClass> kinds(header.width, header.height);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const std::uint8_t code = codes.values()[i];
        if (code > 3) {
            at_ = begin + i;
            refuse("class " + std::to_string(code) + " of a pixel of frame " + std::to_string(number) +
                   ": expected 0 to 3");
        }
        kinds.values()[i] = static_cast<core::PixelClass>(code);
    }
    settle_field(motion.to_previous, kinds, number, -1);
    settle_field(motion.to_next, kinds, number, 1);
    return true;
}

std::string motion_file(const core::MotionField& to_previous, const core::MotionField& to_next,
                        const core::Plane<core::PixelClass>& kinds) {
    const std::array<std::uint32_t, 8> header{mark, 2, static_cast<std::uint32_t>(kinds.width()),
                                              static_cast<std::uint32_t>(kinds.height()), 2};
    std::string bytes(reinterpret_cast<const char*>(header.data()), sizeof header);
    std::vector<std::int16_t> steps;
    for (const core::MotionField* field : {&to_previous, &to_next}) {
        steps.clear();
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const glm::vec2 v = steps_of_a_pixel * field->vector.values()[i];
            const bool fits = std::abs(v.x) < 32767 && std::abs(v.y) < 32767;  // no number does not
            const bool known = fits && field->kind.values()[i] != core::PixelClass::none;
            for (const float step : {v.x, v.y})
                steps.push_back(known ? static_cast<std::int16_t>(std::lround(step)) : no_step);
        }
        bytes.append(reinterpret_cast<const char*>(steps.data()), steps.size() * sizeof(std::int16_t));
    }
    for (const core::PixelClass kind : kinds.values()) bytes.push_back(static_cast<char>(kind));
    return bytes;
}

FrameMotion read_motion_file(const std::filesystem::path& file, std::int64_t number, int width, int height) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw core::Error("reading", file.string(), std::strerror(errno));
    const std::unique_ptr<const int, void (*)(const int*)> closing(&descriptor, [](const int* d) { close(*d); });
    MotionBytes bytes(descriptor, file.string());
    const MotionHeader header = bytes.header(width, height);
    FrameMotion motion;
    if (!bytes.frame(header, number, motion)) throw core::Error("reading", file.string(), "it is cut off");
    return motion;
}

}  // namespace render2mpeg::image
