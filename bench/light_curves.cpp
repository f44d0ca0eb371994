// What light costs by the number of light points and of pixels: one point of the curves of light_curves.sh.
// bench_light_curves SCENE [frame=0] [vpls=32768] [width=512] [height=512] [tolerance=2] [every=16]
// Gathering is measured at every so manieth tile of 16x16 pixels, once light is made, the fastest of three, on one
// thread, and told for the whole picture. Prints one line: light points, width, height; CPU seconds of counting
// paths, of an instant's photons, of planning and growing trees, of gathering; clusters and shadow rays per gather
// point; the process's peak memory in MiB before the light was made and at the end.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/report/statistics.h"
#include "bench/wishes.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg {
namespace {

constexpr int repeats = 3;

/// Leaves every so manieth tile, in diagonals; returns gather points before over after.
double thin_out(renderer::Frame& seen, std::size_t every) {
    const auto across = static_cast<std::size_t>(seen.tiles_across());
    double all = 0, left = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        all += static_cast<double>(seen.tiles[t].size());
        if ((t + t / across) % every != 0) seen.tiles[t].clear();
        left += static_cast<double>(seen.tiles[t].size());
    }
    return all / std::max(left, 1.0);
}

void run(const std::string& scene, const bench::Wishes& wishes) {
    app::RenderOptions options;
    options.cache = "off";
    options.input = scene;
    const int width = wishes.number("width", 512), height = wishes.number("height", 512);
    options.size = {width, height};
    options.samples = 1;
    options.vpls = wishes.number("vpls", 32768);
    options.exposure = 0.0f;
    app::RenderJob film = app::prepare(options);
    const scene::Snapshot world = film.snapshot(wishes.number("frame", 0));
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    renderer::Frame seen = renderer.look(world);
    const double part = thin_out(seen, static_cast<std::size_t>(std::max(1, wishes.number("every", 16))));
    const double memory_before = app::peak_memory_mib();

    renderer.start_chunk(world);
    const double counting = renderer.seconds(renderer::Pass::photons),
                 plans = renderer.seconds(renderer::Pass::direct_tree);
    // The first frame traces photons and grows trees.
    const auto tolerance =
        core::ToleranceMap::uniform(width, height, {0.0f, 0.01f * static_cast<float>(wishes.number("tolerance", 2))});
    double start = app::cpu_seconds();
    renderer.light(world, seen, {tolerance}).radiance;
    const double first = app::cpu_seconds() - start;
    const double photons = renderer.seconds(renderer::Pass::photons) - counting;
    const renderer::Statistics before = renderer.statistics();
    double gathering = 1e30;
    for (int i = 0; i < repeats; ++i) {
        start = app::cpu_seconds();
        renderer.light(world, seen, {tolerance}).radiance;
        gathering = std::min(gathering, app::cpu_seconds() - start);
    }
    const renderer::Statistics& after = renderer.statistics();
    const double trees = plans + std::max(0.0, first - photons - gathering - after.calibration_seconds);
    const auto points = static_cast<double>(after.gather_points - before.gather_points);
    const auto clusters = static_cast<double>(after.direct_clusters + after.indirect_clusters - before.direct_clusters -
                                              before.indirect_clusters);
    fmt::print("{} {} {} {:.3f} {:.3f} {:.3f} {:.3f} {:.1f} {:.1f} {:.0f} {:.0f}\n", after.indirect_points, width,
               height, counting, photons, trees, part * gathering, clusters / points,
               static_cast<double>(after.shadow_rays - before.shadow_rays) / points, memory_before,
               app::peak_memory_mib());
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("bench_light_curves SCENE [frame=] [vpls=] [width=] [height=] [tolerance=] [stop=] [every=]\n",
                   stderr);
        return 2;
    }
    const render2mpeg::parallel::ThreadLimit limit(1);
    render2mpeg::run(argv[1], render2mpeg::bench::Wishes(argc, argv));
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
