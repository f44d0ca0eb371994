#include "bench/coupled_stage.h"

#include <fmt/format.h>

#include <fstream>
#include <optional>

#include "renderer/calibration/audit.h"
#include "scene/pose/motion.h"

namespace render2mpeg::bench {
namespace {

using app::RenderJob;

/// Pixels of each frame whose light is in the name of its file.
constexpr int probed = 256;

class Hash {
  public:
    void add(const void* bytes, std::size_t count) {
        const auto* b = static_cast<const unsigned char*>(bytes);
        for (std::size_t i = 0; i < count; ++i) value_ = (value_ ^ b[i]) * 0x100000001b3u;
    }
    template <class T>
    void add(const core::Plane<T>& plane) {
        add(plane.values().data(), plane.size() * sizeof(T));
    }
    void add(std::int64_t value) { add(&value, sizeof value); }
    void add(float value) { add(&value, sizeof value); }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// What a frame lit without clustering depends on.
std::uint64_t key_of(const RenderJob& film, renderer::Renderer& renderer, const scene::Snapshot& world,
                     const renderer::Frame& seen) {
    Hash hash;
    const renderer::Settings& s = film.rendering;
    for (const std::int64_t value : {world.frame, std::int64_t{s.format.width}, std::int64_t{s.format.height},
                                     std::int64_t{s.samples}, std::int64_t{s.vpls}, std::int64_t{s.direct_points}})
        hash.add(value);
    hash.add(seen.visible.depth);
    hash.add(seen.visible.material);
    hash.add(seen.emitted);
    renderer::Lit dark{{seen, renderer::UngatheredLight(seen)}, {}};
    dark.radiance.frame = world.frame;
    dark.radiance.combined = core::Plane<glm::vec3>(s.format.width, s.format.height, glm::vec3(0));
    dark.radiance.capped = core::Plane<std::uint8_t>(s.format.width, s.format.height, 0);
    for (const renderer::AuditedPixel& p : renderer.audit(world, dark, core::ToleranceMap::reference(), probed)) {
        hash.add(p.luminance);
        hash.add(p.chroma);
    }
    return hash.value();
}

bool read(const std::filesystem::path& file, core::Plane<glm::vec3>& plane) {
    std::ifstream stream(file, std::ios::binary);
    const auto size = static_cast<std::streamsize>(plane.size() * sizeof(glm::vec3));
    return stream.read(reinterpret_cast<char*>(plane.values().data()), size).gcount() == size;
}

core::Picture develop(const RenderJob& film, const core::Plane<glm::vec3>& light, std::int64_t frame) {
    const perceptual::Display display(film.exposure.value_or(0), perceptual::matrix_for(film.format.height));
    core::Radiance radiance;
    radiance.combined = light;
    core::Picture picture = display.develop(radiance);
    picture.number = frame;
    return picture;
}

core::Plane<std::uint8_t> gathering_pixels(const renderer::Frame& seen) {
    core::Plane<std::uint8_t> plane(seen.visible.width(), seen.visible.height(), 0);
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        const int index = static_cast<int>(t), across = seen.tiles_across();
        for (const renderer::GatherPoint& p : seen.tiles[t])
            plane.at(index % across * renderer::tile_size + p.pixel % renderer::tile_size,
                     index / across * renderer::tile_size + p.pixel / renderer::tile_size) = 1;
    }
    return plane;
}

ReferenceFrame lit(const RenderJob& film, renderer::Renderer& renderer, std::int64_t frame,
                   const std::filesystem::path& folder) {
    ReferenceFrame reference;
    const scene::Snapshot world = film.snapshot(frame);
    const renderer::Frame seen = renderer.look(world);
    const std::filesystem::path file = folder / fmt::format("{:016x}.light", key_of(film, renderer, world, seen));
    reference.light = core::Plane<glm::vec3>(film.format.width, film.format.height);
    if (!read(file, reference.light)) {
        reference.light = renderer.light(world, seen, {core::ToleranceMap::reference()}).radiance.combined;
        // Whole or not at all.
        const std::filesystem::path unfinished = file.string() + ".partial";
        std::ofstream(unfinished, std::ios::binary)
            .write(reinterpret_cast<const char*>(reference.light.values().data()),
                   static_cast<std::streamsize>(reference.light.size() * sizeof(glm::vec3)));
        std::filesystem::rename(unfinished, file);
    }
    reference.picture = develop(film, reference.light, frame);
    reference.gathers = gathering_pixels(seen);
    return reference;
}

}  // namespace

Stage stage_of(const RenderJob& film, int pairs, const std::filesystem::path& folder) {
    Stage stage;
    std::filesystem::create_directories(folder);
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    renderer.start_chunk(film.snapshot(film.frames.first));
    for (int i = 0; i < pairs; ++i)
        stage.firsts.push_back(film.frames.first + (film.frame_count() - 2) * (2 * i + 1) / (2 * pairs));
    for (const std::int64_t first : stage.firsts)
        for (const std::int64_t n : {first, first + 1})
            if (!stage.reference.contains(n)) stage.reference[n] = lit(film, renderer, n, folder);
    for (std::int64_t n = film.frames.first; n <= film.frames.last; ++n) {
        const scene::Snapshot world = film.snapshot(n);
        stage.visible.push_back(renderer.look(world).visible);
        stage.motion.push_back(scene::motion_between(stage.visible.back(), world,
                                                     film.snapshot(std::max<std::int64_t>(film.frames.first, n - 1))));
    }
    return stage;
}

}  // namespace render2mpeg::bench
