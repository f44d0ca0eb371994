#include "app/estimate/memory_need.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "app/job/scene_settings.h"
#include "app/loop/grain_cost.h"
#include "app/system/memory_limit.h"
#include "core/error.h"
#include "core/numeric.h"
#include "encoder/codec.h"
#include "image/image.h"
#include "renderer/surface/opacity_map.h"

namespace render2mpeg::app {
namespace {

/// Bytes of one, beside the scene as it was read: what was measured and 10 to 30 % more. fit:
/// docs/measurements.md#memory
constexpr std::uint64_t per_triangle = 135;
constexpr std::uint64_t per_lamp = 1300;
constexpr std::uint64_t per_vpl = 600;  ///< as many as are asked for, about
constexpr std::uint64_t per_pixel = 250, per_sample = 60;
constexpr std::uint64_t per_pixel_looked_at_closer = 500;
constexpr std::uint64_t per_exposed_sample = 40;
/// Cells that rays ask, records, rays in flight: they grow as a picture's sides do. A room full of small things takes
/// all of it, an open field a sixth.
constexpr std::uint64_t per_asking_edge = 1'100'000;
constexpr std::uint64_t samples_of_blurred_lamps = 32;  ///< of a pixel on the average, where a lens blurs
constexpr std::uint64_t per_decoded_pixel = 48;
constexpr std::uint64_t per_kept_pixel = 8;  ///< of a chunk's pictures, which are coded until it has its rate
/// Of light within a volume: samples of a lamp's way, and cells with their equations. Of what shines, while its parts
/// are found.
constexpr std::uint64_t per_way = 36, most_ways = std::uint64_t{1} << 19, most_volume_lamps = 16;
constexpr std::uint64_t cells_of_volume = std::uint64_t{160} << 20, per_shining_voxel = 28;
constexpr std::uint64_t always = std::uint64_t{38} << 20;  ///< libraries of films among it, which are opened late

/// Triangles and segments of strands in Embree: rigid objects share their mesh's, others have their own; still ones
/// that light goes below stand in a second tree.
std::uint64_t triangles_of(const scene::Animation& film) {
    std::uint64_t count = 0;
    std::set<int> shared;
    for (const scene::Object& object : film.objects) {
        const std::uint64_t own = film.meshes[static_cast<std::size_t>(object.mesh)].primitives();
        if (object.mobility != scene::Mobility::rigid || shared.insert(object.mesh).second) count += own;
        const bool walked = film.materials[static_cast<std::size_t>(object.material)].subsurface.has_value();
        if (walked && object.mobility == scene::Mobility::still) count += own;
    }
    return count;
}

/// Samples over shutter and lens of a pixel of the finest picture; 0: none.
std::uint64_t most_exposure_samples(const RenderJob& film) {
    if (!film.plan.runs(renderer::Pass::shutter) && !film.plan.runs(renderer::Pass::lens)) return 0;
    const bool fixed = film.coding.rate_control.mode == encoder::RateMode::constant_quantiser;
    return static_cast<std::uint64_t>(
               exposure_samples(film, fixed ? film.coding.quantiser : encoder::facts_of(film.coding.codec).finest)
                   .most) +
           (film.plan.runs(renderer::Pass::lens) ? samples_of_blurred_lamps : 0);
}

/// Pixels that are kept until their chunk has its rate.
std::uint64_t kept_pixels(const RenderJob& film) {
    if (!film.two_passes || film.coding.codec == encoder::Codec::mpeg2) return 0;
    const Chunk chunk = chunks_of(film.frames, film.coding.gop).front();
    return static_cast<std::uint64_t>(chunk.last - chunk.first + 1) * static_cast<std::uint64_t>(film.format.width) *
           static_cast<std::uint64_t>(film.format.height);
}

/// Pixels that are kept until grain's bits are told.
std::uint64_t grained_pixels(const RenderJob& film) {
    return grain_pictures(film.film()) * static_cast<std::uint64_t>(film.format.width) *
           static_cast<std::uint64_t>(film.format.height);
}

/// Memory of a codec beside MPEG-2's pictures: its library, and pictures that it looks ahead at.
std::uint64_t codec_memory(const RenderJob& film, std::uint64_t pixels) {
    if (film.kind != OutputKind::film) return 0;
    switch (film.coding.codec) {
        case encoder::Codec::h264:
        case encoder::Codec::h264_lossless:
            return (std::uint64_t{6} << 20) + 60 * pixels;
        case encoder::Codec::hevc:
            return (std::uint64_t{34} << 20) + 410 * pixels;
        case encoder::Codec::av1:
            return (std::uint64_t{54} << 20) + 760 * pixels;
        case encoder::Codec::ffv1:
            return (std::uint64_t{4} << 20) + 220 * pixels;
        case encoder::Codec::vp9:  // alpha is a second stream
            return film.coding.alpha ? (std::uint64_t{28} << 20) + 170 * pixels
                                     : (std::uint64_t{14} << 20) + 60 * pixels;
        case encoder::Codec::gif:
            return (std::uint64_t{1} << 20) + (film.coding.alpha ? 240 : 40) * pixels;
        case encoder::Codec::prores4444:
        case encoder::Codec::prores4444xq:
            return (film.coding.alpha ? 240 : 22) * pixels;
        case encoder::Codec::dnxhr:
            return 10 * pixels;
        default:
            return 0;
    }
}

/// Grids of one file, posed in a chunk, and light within them.
std::uint64_t in_chunk(const scene::Volume& volume, std::uint64_t lamps) {
    const std::uint64_t voxels = volume.outline.bytes / sizeof(float);
    const std::uint64_t light = per_way * std::min(voxels, most_ways) * std::min(lamps, most_volume_lamps);
    return light + cells_of_volume + (volume.emits() ? per_shining_voxel * voxels : 0) +
           (volume.grids ? 0 : volume.outline.bytes);
}

/// Tables of where textures cut out surfaces.
std::uint64_t for_cut_outs(const scene::Animation& scene) {
    std::uint64_t triangles = 0;
    for (const scene::Object& object : scene.objects) {
        const scene::Material& m = scene.materials[static_cast<std::size_t>(object.material)];
        if (m.alpha_mode != scene::AlphaMode::opaque && (m.base_color_texture.present() || m.alpha_texture.present()))
            triangles += scene.meshes[static_cast<std::size_t>(object.mesh)].primitives();
    }
    return std::min<std::uint64_t>(triangles * renderer::OpacityMaps::most_bytes_of_triangle,
                                   renderer::OpacityMaps::most_bytes);
}

/// Pixels along the side of a square picture.
std::uint64_t edge_of(std::uint64_t pixels) {
    return static_cast<std::uint64_t>(std::sqrt(static_cast<double>(pixels)));
}

std::string size_text(std::uint64_t bytes) {
    const double mib = static_cast<double>(bytes) / (1 << 20);
    return mib < 1000 ? fmt::format("{:.0f} MiB", mib) : fmt::format("{:.1f} GiB", mib / 1024);
}

}  // namespace

MemoryNeed memory_need(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    MemoryNeed need;
    need.held = own_memory().resident;
    need.triangles = per_triangle * triangles_of(scene);
    for (const scene::Object& object : scene.objects)
        if (object.mobility == scene::Mobility::deforming)
            need.moving += per_triangle * scene.meshes[static_cast<std::size_t>(object.mesh)].primitives();
    for (const auto& [image, header] : film.images->headers()) {
        const std::uint64_t pixels =
            static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
        // Mip levels take a third more.
        need.textures += pixels * (header.bytes ? 4 : 16) * 4 / 3;
        need.decoding = std::max(need.decoding, per_decoded_pixel * pixels);
    }
    need.textures += for_cut_outs(scene);
    if (film.plan.runs(renderer::Pass::volumes))
        for (const scene::Volume& volume : scene.volumes) {
            const std::uint64_t own = in_chunk(volume, scene.lights.size());
            // The file before stays beside it.
            need.volumes += own + (volume.files.size() > 1 ? volume.outline.bytes : 0);
            need.moving += own;
        }
    const bool asks = film.rendering.indirect == renderer::Indirect::rays;
    need.lights = per_lamp * (static_cast<std::uint64_t>(film.rendering.direct_points) + scene.lights.size()) +
                  (asks ? 0 : per_vpl * static_cast<std::uint64_t>(film.rendering.vpls));
    const std::uint64_t closer = film.rendering.most_samples > 0 ? per_pixel_looked_at_closer : 0;
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(film.format.width) * static_cast<std::uint64_t>(film.format.height);
    need.frames = always + codec_memory(film, pixels) +
                  (per_pixel + closer + per_sample * static_cast<std::uint64_t>(film.rendering.samples) +
                   per_exposed_sample * most_exposure_samples(film)) *
                      pixels +
                  per_kept_pixel * (kept_pixels(film) + grained_pixels(film));
    if (asks) need.asked = per_asking_edge * edge_of(pixels);
    return need;
}

MemoryNeed by_sample(MemoryNeed film, const MemoryNeed& sample, std::uint64_t taken) {
    // chosen: a third more, which no film of 4, 16 and 64 times the sample's pixels takes.
    constexpr double more = 1.35, scene_told = 1.3;
    const double held = static_cast<double>(sample.held),
                 known = held + (static_cast<double>(sample.scene()) - held) / scene_told +
                         static_cast<double>(sample.frames - always),
                 edges = core::divide_or(static_cast<double>(film.asked), static_cast<double>(sample.asked), 0.0);
    film.asked = static_cast<std::uint64_t>(more * edges * std::max(static_cast<double>(taken) - known, 0.0));
    return film;
}

bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads) {
    if (need.total(std::max(threads, 1)) <= limit) return true;
    if (need.total() <= limit) return false;
    throw core::Error(
        "rendering", film.animation->source,
        fmt::format(
            "it takes about {}, and --memory allows {}: {} for what was read, {} for triangles, {} for textures, "
            "{} to read the largest of them, {} for volumes, {} for lights, {} for frames",
            size_text(need.total()), size_text(limit), size_text(need.held), size_text(need.triangles),
            size_text(need.textures), size_text(need.decoding), size_text(need.volumes), size_text(need.lights),
            size_text(need.frames + need.asked)));
}

}  // namespace render2mpeg::app
