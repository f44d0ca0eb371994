// What light changes by along motion where things move, in the films of mover_scenes.h. bench_light_flicker
// [SCENE|all] [size=32] [first=3] [frames=4] [tolerances=2,8] [points=19] prints, for each film: what it changes by
// from frame to frame where nothing is noise (2^points VPLs, cuts of 0.1 %), as a share of the light;
// then, over that, what it changes by with the VPLs of a film, every one of them gathered, and with cuts at each
// tolerance (per cent), whose errors against those (root mean square over pixels and frames, as a share of the light),
// shadow rays per pixel and CPU microseconds per pixel (gathering and seeing, one thread) stand beside it.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bench/mover_scenes.h"
#include "bench/wishes.h"
#include "core/error.h"
#include "parallel/loops.h"
#include "tests/renderer/moving_light_film.h"

namespace render2mpeg {
namespace {

/// Root mean square of what one has over the other, pixel by pixel.
double error_of(const test::FrameLuminances& frames, const test::FrameLuminances& truth) {
    double squares = 0, count = 0;
    for (std::size_t n = 0; n < frames.size(); ++n)
        for (std::size_t i = 0; i < frames[n].size(); ++i) {
            const double t = truth[n].values()[i];
            if (!(t > 0.0)) continue;
            const double e = frames[n].values()[i] / t - 1;
            squares += e * e;
            count += 1;
        }
    return std::sqrt(squares / std::max(count, 1.0));
}

void run(const std::string& name, const bench::Wishes& wishes) {
    const int size = wishes.number("size", 32), first = wishes.number("first", 3), count = wishes.number("frames", 4);
    test::MovingLightFilm film(bench::mover_scene(name), size);
    test::FilmLight usual, fine;
    fine.virtual_lights.vpls = 1 << wishes.number("points", 19);
    fine.tolerance = core::ToleranceMap::uniform(size, size, {0.0f, 0.001f});
    const double reference = film.flicker(film.lit(fine, first, count), first);
    const test::FrameLuminances whole = film.lit(usual, first, count);
    const double of_points = film.flicker(whole, first);
    fmt::print("| {} | {:.4f} | {:.3f} |", name, reference, of_points / reference);
    const std::string tolerances = wishes.text("tolerances", "2,8");
    for (std::size_t start = 0; start < tolerances.size();) {
        const std::size_t comma = std::min(tolerances.find(',', start), tolerances.size());
        const float per_cent = std::strtof(tolerances.substr(start, comma - start).c_str(), nullptr);
        start = comma + 1;
        usual.tolerance = core::ToleranceMap::uniform(size, size, {0.0f, 0.01f * per_cent});
        test::FilmCost cost;
        const test::FrameLuminances cuts = film.lit(usual, first, count, &cost);
        const double pixels = static_cast<double>(size) * size * count;
        fmt::print(" {:g} %: {:.3f}, {:.2f} %, {:.0f}, {:.1f} |", per_cent, film.flicker(cuts, first) / reference,
                   100 * error_of(cuts, whole), static_cast<double>(cost.shadow_rays) / pixels,
                   1e6 * cost.seconds / pixels);
    }
    fmt::print("\n");
    std::fflush(stdout);
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("bench_light_flicker SCENE|all [size=] [first=] [frames=] [tolerances=] [points=]\n", stderr);
        return 2;
    }
    const render2mpeg::parallel::ThreadLimit limit(1);  // so that CPU seconds are those of the work
    const render2mpeg::bench::Wishes wishes(argc, argv);
    fmt::print("| film | changes | points | cuts: changes, error, rays, microseconds |\n|---|---|---|---|\n");
    const std::string wanted = argv[1];
    for (const std::string& name : render2mpeg::bench::names_of_mover_scenes())
        if (wanted == "all" || wanted == name) render2mpeg::run(name, wishes);
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
