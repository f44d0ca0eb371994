#include "app/loop/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "core/error.h"
#include "image/image.h"
#include "renderer/lights/anchors.h"

namespace render2mpeg::app {
namespace {

/// Bytes of one, beside the scene as it was read: what was measured and 10 to 30 % more. fit: docs/fits/memory
constexpr std::uint64_t per_triangle = 135;
constexpr std::uint64_t per_lamp = 1300;
constexpr std::uint64_t per_candidate = 400;  ///< of the places that anchors are chosen from
constexpr std::uint64_t per_pixel = 250, per_sample = 60;
constexpr std::uint64_t per_decoded_pixel = 48;
constexpr std::uint64_t always = std::uint64_t{24} << 20;

/// Memory of this process in bytes: what is there, and what may be written to, there or not.
struct OwnMemory {
    std::uint64_t resident = 0, writable = 0;
};

OwnMemory memory_now() {
    std::uintmax_t resident = 0, writable = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(statm, "%*u %ju %*u %*u %*u %ju", &resident, &writable) != 2) resident = writable = 0;
        std::fclose(statm);
    }
    const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    return {resident * page, writable * page};
}

/// Triangles as rays meet them: those of an object that never moves by object, others by mesh.
std::uint64_t triangles_of(const scene::Animation& film) {
    std::uint64_t count = 0;
    std::set<int> shared;
    for (const scene::Object& object : film.objects)
        if (object.mobility != scene::Mobility::rigid || shared.insert(object.mesh).second)
            count += film.meshes[static_cast<std::size_t>(object.mesh)].triangles.size();
    return count;
}

std::string size_text(std::uint64_t bytes) {
    const double mib = static_cast<double>(bytes) / (1 << 20);
    return mib < 1000 ? fmt::format("{:.0f} MiB", mib) : fmt::format("{:.1f} GiB", mib / 1024);
}

}  // namespace

std::set<int> images_of(const scene::Animation& film) {
    std::set<int> images;
    for (const scene::Object& object : film.objects) {
        const scene::Material& m = film.materials[static_cast<std::size_t>(object.material)];
        for (const scene::TextureUse* use :
             {&m.base_color_texture, &m.metallic_roughness_texture, &m.specular_glossiness_texture, &m.normal_texture,
              &m.emission_texture, &m.alpha_texture, &m.transmission_texture})
            if (use->present()) images.insert(use->image);
    }
    if (film.sky.image >= 0) images.insert(film.sky.image);
    return images;
}

std::uint64_t memory_from(const std::string& text) {
    double number = 0;
    char unit = 0, more = 0;
    const int read = std::sscanf(text.c_str(), "%lf%c%c", &number, &unit, &more);
    constexpr std::string_view units = "KMGT";
    const std::size_t power = units.find(unit);
    // chosen: below 16 MiB no program starts; above an exbibyte no machine does.
    if (read == 2 && power != std::string_view::npos && number > 0) {
        for (std::size_t i = 0; i <= power; ++i) number *= 1024;
        if (number >= 16.0 * 1024 * 1024 && number < 1e18) return static_cast<std::uint64_t>(number);
    }
    throw core::Error("memory " + text + ": expected a size such as 8G, 1.5G or 900M");
}

MemoryNeed memory_need(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    MemoryNeed need;
    need.held = memory_now().resident;
    need.triangles = per_triangle * triangles_of(scene);
    for (const int i : images_of(scene)) {
        const scene::ImageSource& source = scene.images[static_cast<std::size_t>(i)];
        const image::ImageHeader header = image::read_image_header(source.path, source.bytes, source.name);
        const std::uint64_t pixels =
            static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
        // Halves of halves: a third more.
        need.textures += pixels * (header.bytes ? 4 : 16) * 4 / 3;
        need.decoding = std::max(need.decoding, per_decoded_pixel * pixels);
    }
    need.lights = per_lamp * (static_cast<std::uint64_t>(film.rendering.direct_points) + scene.lights.size()) +
                  per_candidate * renderer::candidates_for(static_cast<std::uint64_t>(film.rendering.vpls));
    need.frames = always + (per_pixel + per_sample * static_cast<std::uint64_t>(film.rendering.samples)) *
                               static_cast<std::uint64_t>(film.format.width) *
                               static_cast<std::uint64_t>(film.format.height);
    return need;
}

void hold_to(std::uint64_t limit, int threads) {
    // What is told of is what is there. The system counts what may be written to, of which stacks and heaps keep much
    // in store: what they do now, and for each thread to come.
    // chosen: 256 MiB of Embree's and TBB's, and 16 by thread, with which the smallest films that are reckoned to fit
    // do (1, 2 and 8 threads; with half of it Embree does not start).
    const OwnMemory own = memory_now();
    constexpr std::uint64_t in_store = std::uint64_t{256} << 20, by_thread = std::uint64_t{16} << 20;
    limit += own.writable > own.resident ? own.writable - own.resident : 0;
    limit += in_store + by_thread * static_cast<std::uint64_t>(std::max(threads, 1));
#ifndef RENDER2MPEG_SANITIZED
    // Of private memory alone: libraries and files that are mapped can be had again without swapping. Sanitizers map
    // more than there is.
    const rlimit memory{limit, limit};
    setrlimit(RLIMIT_DATA, &memory);
#endif
}

bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads) {
    if (need.total() + need.decoding * static_cast<std::uint64_t>(std::max(threads - 1, 0)) <= limit) return true;
    if (need.total() <= limit) return false;
    throw core::Error(
        "rendering", film.animation->source,
        fmt::format(
            "it takes about {}, and --memory allows {}: {} for what was read, {} for triangles, {} for textures, "
            "{} to read the largest of them, {} for lights, {} for frames",
            size_text(need.total()), size_text(limit), size_text(need.held), size_text(need.triangles),
            size_text(need.textures), size_text(need.decoding), size_text(need.lights), size_text(need.frames)));
}

}  // namespace render2mpeg::app
