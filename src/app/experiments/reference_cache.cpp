#include "app/experiments/reference_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <type_traits>
#include <utility>

#include "app/files/file_io.h"
#include "core/error.h"
#include "renderer/gather/final_gather.h"
#include "renderer/surface/frame.h"

namespace render2mpeg::app {
namespace {

/// Pixels of each frame whose light is part of the key, so that no change of light goes unnoticed.
constexpr int probed = 256;

template <class T>
void add(Checksum& sum, const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_same_v<T, glm::vec3>, "nothing that is padded");
    sum.add({reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
}
template <class T>
void add_plane(Checksum& sum, const core::Plane<T>& plane) {
    sum.add({reinterpret_cast<const std::uint8_t*>(plane.values().data()), plane.size() * sizeof(T)});
}
/// All members that a gather point's light depends on.
void add(Checksum& sum, const renderer::GatherPoint& p) {
    const renderer::Bsdf& bsdf = p.point.bsdf;
    for (const glm::vec3& v :
         {p.weight, p.point.position, p.point.geometric_normal, p.point.shading_normal, p.point.outgoing,
          p.point.emission, bsdf.diffuse, bsdf.f0, bsdf.f90, bsdf.mirror, bsdf.transmission})
        add(sum, v);
    add(sum, bsdf.alpha);
    add(sum, p.pixel);
}

struct Header {
    char mark[8] = {'r', '2', 'm', 'r', 'e', 'f', '1', '\n'};
    std::int32_t width = 0, height = 0;
    double seconds = 0;
    std::uint64_t checksum = 0;  ///< of the light
};

std::uint64_t checksum_of(const core::Plane<glm::vec3>& light) {
    Checksum sum;
    add_plane(sum, light);
    return sum.value();
}

}  // namespace

ReferenceCache::ReferenceCache(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (!std::filesystem::is_directory(folder_, error))
        throw core::Error("keeping references in", folder_.string(), "this is no folder, and none can be made");
}

std::filesystem::path ReferenceCache::file_of(std::uint64_t key) const {
    return folder_ / fmt::format("{:016x}.light", key);
}

std::uint64_t ReferenceCache::key_of(const RenderJob& film, renderer::Renderer& renderer, const scene::Snapshot& world,
                                     const renderer::PlacedFrame& placed) const {
    const renderer::Frame& seen = placed.frame;
    if (folder_.empty()) return 0;
    Checksum sum;
    const renderer::Settings& s = film.rendering;
    sum.add(std::string_view(RENDER2MPEG_VERSION));
    sum.add(std::string_view(core::name_of(s.isa)));
    for (const std::int64_t value :
         {world.frame, std::int64_t{s.format.width}, std::int64_t{s.format.height}, std::int64_t{s.samples},
          std::int64_t{s.edge_samples}, std::int64_t{s.most_samples}, std::int64_t{s.vpls},
          std::int64_t{s.direct_points}, static_cast<std::int64_t>(s.clamp), static_cast<std::int64_t>(s.bounces),
          static_cast<std::int64_t>(s.seed)})
        add(sum, value);
    for (const renderer::GatherTile& tile : seen.tiles) {
        add(sum, tile.size());
        for (const renderer::GatherPoint& p : tile) add(sum, p);
    }
    add_plane(sum, placed.ungathered.all());
    add_plane(sum, placed.ungathered.specular());
    if (seen.exposure) {
        add_plane(sum, seen.exposure->exposed);
        add_plane(sum, seen.exposure->emitted);
        for (const auto& tile : seen.exposure->contributions)
            for (const renderer::Contribution& c : tile) {
                add(sum, c.point);
                add(sum, c.weight);
                add(sum, c.diffuse);
            }
    }
    renderer::Lit dark{placed, {}};
    dark.radiance.frame = world.frame;
    dark.radiance.combined = core::Plane<glm::vec3>(s.format.width, s.format.height, glm::vec3(0));
    dark.radiance.capped = core::Plane<std::uint8_t>(s.format.width, s.format.height, 0);
    for (const renderer::AuditedPixel& p : renderer.audit(world, dark, core::ToleranceMap::reference(), probed)) {
        add(sum, p.luminance);
        add(sum, p.chroma);
    }
    return sum.value();
}

std::optional<KeptReference> ReferenceCache::find(std::uint64_t key, int width, int height) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream stream(file_of(key), std::ios::binary);
    Header header;
    const Header right;
    if (!stream.read(reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
    if (std::memcmp(header.mark, right.mark, sizeof right.mark) != 0 || header.width != width ||
        header.height != height || !(header.seconds >= 0))
        return std::nullopt;
    KeptReference kept{core::Plane<glm::vec3>(width, height), header.seconds};
    const auto size = static_cast<std::streamsize>(kept.light.size() * sizeof(glm::vec3));
    if (!stream.read(reinterpret_cast<char*>(kept.light.values().data()), size)) return std::nullopt;
    if (stream.get() != std::ifstream::traits_type::eof() || checksum_of(kept.light) != header.checksum)
        return std::nullopt;
    return kept;
}

void ReferenceCache::keep(std::uint64_t key, const KeptReference& reference) const {
    if (folder_.empty()) return;
    Header header;
    header.width = reference.light.width();
    header.height = reference.light.height();
    header.seconds = reference.seconds;
    header.checksum = checksum_of(reference.light);
    // Whole or not at all.
    const std::filesystem::path unfinished = file_of(key).string() + fmt::format(".{}.partial", getpid());
    std::error_code ignored;
    {
        std::ofstream stream(unfinished, std::ios::binary);
        stream.write(reinterpret_cast<const char*>(&header), sizeof header);
        stream.write(reinterpret_cast<const char*>(reference.light.values().data()),
                     static_cast<std::streamsize>(reference.light.size() * sizeof(glm::vec3)));
        if (stream.flush()) {
            stream.close();
            std::filesystem::rename(unfinished, file_of(key), ignored);
            if (!ignored) return;
        }
    }
    std::filesystem::remove(unfinished, ignored);
}

std::string reference_light(const RenderJob& film, std::size_t light_points) {
    const std::string points = fmt::format("{} light point{}", light_points, light_points == 1 ? "" : "s");
    if (film.rendering.indirect != renderer::Indirect::rays || film.rendering.vpls == 0) return points;
    return points + fmt::format(" and {} rays a point", renderer::most_gather_rays);
}

}  // namespace render2mpeg::app
