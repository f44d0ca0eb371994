// How near `shade` is to the speed of its rays alone: the shadow rays of a frame are recorded and traced again, packet
// by packet, on one thread. bench_replay SCENE [TOLERANCE% = 2] [classic|honest] [FRAME = 0]; 512x512, one eye sample,
// 9,000 VPLs, every sixteenth tile of 16x16 pixels.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg {
namespace {

constexpr int picture_size = 512, vpls = 9000, repeats = 3;
constexpr std::size_t tile_step = 16;

/// Leaves every sixteenth tile, in diagonals.
void thin_out(renderer::Seen& seen) {
    const auto across = static_cast<std::size_t>(seen.tiles_across());
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        if ((t + t / across) % tile_step != 0) seen.tiles[t].clear();
}

/// CPU seconds of the fastest of some runs.
template <class Run>
double fastest(Run run) {
    double least = 1e30;
    for (int i = 0; i < repeats; ++i) {
        const double start = app::cpu_seconds();
        run();
        least = std::min(least, app::cpu_seconds() - start);
    }
    return least;
}

void measure(const app::RenderJob& film, float tolerance, std::int64_t frame) {
    const scene::Snapshot world = film.snapshot(frame);
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    renderer.start_chunk(world);
    renderer::Seen seen = renderer.see(world);
    thin_out(seen);
    const auto wanted = core::ToleranceMap::uniform(picture_size, picture_size, {0.0f, tolerance});
    renderer.shade(world, seen, wanted);  // makes the light, which is not to be measured

    std::vector<renderer::ShadowPacket> packets;
    const renderer::Statistics before = renderer.statistics();
    renderer.tracer().record(&packets);
    renderer.shade(world, seen, wanted);
    renderer.tracer().record(nullptr);
    const renderer::Statistics after = renderer.statistics();
    const double shade = fastest([&] { renderer.shade(world, seen, wanted); });
    std::uint64_t blocked = 0;
    const double replay = fastest([&] {
        for (const renderer::ShadowPacket& packet : packets)
            blocked += static_cast<std::uint64_t>(__builtin_popcount(renderer.tracer().occluded(packet, nullptr)));
    });

    const auto points = static_cast<double>(after.gather_points - before.gather_points);
    const auto rays = static_cast<double>(after.shadow_rays - before.shadow_rays);
    const auto clusters = static_cast<double>(after.direct_clusters + after.indirect_clusters - before.direct_clusters -
                                              before.indirect_clusters);
    fmt::print("{} points, {:.0f} clusters and {:.0f} rays each, {:.1f} rays per packet, {:.0f} % blocked\n", points,
               clusters / points, rays / points, rays / static_cast<double>(packets.size()),
               100.0 * static_cast<double>(blocked) / repeats / rays);
    fmt::print(
        "shade {:.3f} s: {:.1f} M clusters/s, {:.1f} M rays/s; its rays alone {:.3f} s, {:.1f} M rays/s: {:.0f} %\n",
        shade, 1e-6 * clusters / shade, 1e-6 * rays / shade, replay, 1e-6 * rays / replay, 100.0 * replay / shade);
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    using namespace render2mpeg;
    if (argc < 2) {
        std::fputs("bench_replay SCENE [TOLERANCE%] [classic|honest] [FRAME]\n", stderr);
        return 2;
    }
    const parallel::ThreadLimit limit(1);
    app::RenderOptions options;
    options.cache = "off";
    options.input = argv[1];
    options.size = fmt::format("{0}x{0}", picture_size);
    options.samples = 1;
    options.vpls = vpls;
    app::RenderJob film = app::prepare(options);
    if (argc > 3)
        film.rendering.stop = std::string(argv[3]) == "classic" ? renderer::Stop::classic : renderer::Stop::honest;
    measure(film, argc > 2 ? 0.01f * std::strtof(argv[2], nullptr) : 0.02f, argc > 4 ? std::atoll(argv[4]) : 0);
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
