#include "encoder_rd/exact_motion.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <utility>
#include <vector>

#include "core/error.h"
#include "renderer/renderer.h"
#include "scene/pose/motion.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::bench {
namespace {

namespace fs = std::filesystem;

/// Bits 31..16: 64 x; 15..2: 32 y; 1..0: class.
using Packed = std::uint32_t;

Packed pack(glm::vec2 v, core::PixelClass kind) {
    const float x = std::round(64 * v.x), y = std::round(32 * v.y);
    const bool fits = std::abs(x) < 32768 && std::abs(y) < 8192;  // false for NaN too
    if (!fits || kind == core::PixelClass::none) return 0;
    return static_cast<Packed>(static_cast<int>(x) + 32768) << 16 |
           static_cast<Packed>(static_cast<int>(y) + 8192) << 2 | static_cast<Packed>(kind);
}

void unpack(Packed packed, glm::vec2& v, core::PixelClass& kind) {
    kind = static_cast<core::PixelClass>(packed & 3);
    v = kind == core::PixelClass::none
            ? glm::vec2(0)
            : glm::vec2(static_cast<float>(static_cast<int>(packed >> 16) - 32768) / 64,
                        static_cast<float>(static_cast<int>(packed >> 2 & 0x3fff) - 8192) / 32);
}

std::vector<Packed> read(const fs::path& file, std::size_t count) {
    std::vector<Packed> packed(count);
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(count * sizeof(Packed))))
        return {};
    return packed;
}

/// Under another name until it is whole, since several runs may share the folder.
void write(const fs::path& file, const std::vector<Packed>& packed) {
    const fs::path part = file.string() + fmt::format(".{}", static_cast<const void*>(&packed));
    std::ofstream(part, std::ios::binary)
        .write(reinterpret_cast<const char*>(packed.data()),
               static_cast<std::streamsize>(packed.size() * sizeof(Packed)));
    fs::rename(part, file);
}

}  // namespace

ExactMotion::ExactMotion(app::RenderJob film, fs::path folder) : film_(std::move(film)), folder_(std::move(folder)) {
    film_.rendering.samples = 1;
    fs::create_directories(folder_);
}

ExactMotion::~ExactMotion() = default;

core::MotionField ExactMotion::look(std::int64_t picture, std::int64_t reference) {
    if (!renderer_) {
        const renderer::Plan plan =
            renderer::make_plan(scene::traits_of(*film_.animation),
                                {.picture = false, .film = true, .layers = false, .indirect = false, .without = {}});
        renderer_ = std::make_unique<renderer::Renderer>(*film_.animation, film_.rendering, plan);
        renderer_->start_chunk(film_.snapshot(0));
    }
    const scene::Snapshot world = film_.snapshot(picture);
    if (seen_ != picture) visible_ = renderer_->look(world).visible;
    seen_ = picture;
    return scene::motion_between(visible_, world, film_.snapshot(reference));
}

const core::MotionField& ExactMotion::between(std::int64_t picture, std::int64_t reference) {
    if (picture != picture_) fields_.clear();
    picture_ = picture;
    const auto [at, is_new] = fields_.try_emplace(reference);
    core::MotionField& field = at->second;
    if (!is_new) return field;

    // Take it from the folder, or look once more, without light or textures. What comes out is the same both times.
    const auto count = static_cast<std::size_t>(film_.format.width) * static_cast<std::size_t>(film_.format.height);
    const fs::path file = folder_ / fmt::format("{:02}-{:02}", picture, reference);
    std::vector<Packed> packed = read(file, count);
    if (packed.empty()) {
        const core::MotionField seen = look(picture, reference);
        for (std::size_t i = 0; i < count; ++i) packed.push_back(pack(seen.vector.values()[i], seen.kind.values()[i]));
        write(file, packed);
    }
    field.picture = picture;
    field.reference = reference;
    field.vector = core::Plane<glm::vec2>(film_.format.width, film_.format.height);
    field.kind = core::Plane<core::PixelClass>(film_.format.width, film_.format.height);
    for (std::size_t i = 0; i < count; ++i) unpack(packed[i], field.vector.values()[i], field.kind.values()[i]);
    return field;
}

}  // namespace render2mpeg::bench
