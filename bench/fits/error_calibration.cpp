// The fit of how the stopping rule learns its error scale (docs/measurements.md#error-scale).
//
//   fit_error_calibration OUT.csv NAME=SCENE...
//
// First table: what pixels need at a range of error scales, one pixel of one 4x4 block in every tile. Second: how well
// the error scale that a film learns from its own pixels keeps the promise, and what it costs against the law as it
// stands and against the classic rule at the part of the tolerance that keeps the same promise in that very film. What
// each pixel needs goes into OUT.csv.needs, for error_scale_tail.py.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/job/automatic_exposure.h"
#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/color.h"
#include "core/error.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/calibration/audit.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg {
namespace {

constexpr int picture_size = 512, vpls = 9000, frames_per_scene = 2, audited = 1024;
constexpr double promise = 0.01;
const std::vector<double> tolerances{0.02, 0.08, 0.26};
const std::vector<double> error_scales{1.0, 0.5, 0.25, 0.125};

/// What one way to stop came to; sums over frames.
struct Outcome {
    std::vector<float> errors;  ///< what is noticed of each audited pixel's error, over its tolerance
    double rays = 0, seconds = 0, points = 0, error_scale = 0;

    double over() const {
        const auto beyond = std::count_if(errors.begin(), errors.end(), [](float e) { return e > 1.0f; });
        return static_cast<double>(beyond) / static_cast<double>(errors.size());
    }
    double quantile(double q) const {
        std::vector<float> sorted = errors;
        std::sort(sorted.begin(), sorted.end());
        return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
    }
};

class Bench {
  public:
    explicit Bench(const std::string& path) : film_(prepared(path)) {
        const perceptual::Display display(*film_.exposure, perceptual::matrix_for(picture_size));
        floor_ = core::luminance(display.with_luma(glm::vec3(1), 16.5f));
        for (int f = 0; f < frames_per_scene; ++f) {
            worlds_.push_back(
                film_.snapshot(film_.frames.first + film_.frame_count() * (2 * f + 1) / (2 * frames_per_scene)));
            told_.push_back(new_renderer(false));
            renderer::Renderer& renderer = *told_.back();
            renderer.start_chunk(worlds_.back());
            seen_.push_back(thinned(renderer.look(worlds_.back())));
            pixels_.push_back(renderer::drawn(renderer::lit_pixels(seen_.back()), audited, worlds_.back().frame));
            const core::Radiance all =
                renderer.light(worlds_.back(), only(seen_.back(), pixels_.back()), {core::ToleranceMap::reference()})
                    .radiance;
            truth_.emplace_back();
            for (const renderer::LitPixel& p : pixels_.back()) {
                const glm::ivec2 place = renderer::place_of(seen_.back(), p);
                truth_.back().push_back(all.combined.at(place.x, place.y));
            }
        }
    }

    /// Without `error_scale` each frame is a chunk that learns its own; with one, errors count so many times, which is
    /// to divide the tolerances.
    Outcome run(double tolerance, double part, std::optional<double> error_scale) const {
        Outcome sum;
        const auto relative = static_cast<float>(tolerance),
                   scale = static_cast<float>(1.0 / (part * error_scale.value_or(1.0)));
        const auto promised = core::ToleranceMap::uniform(picture_size, picture_size, {floor_, relative}),
                   map = core::ToleranceMap::uniform(picture_size, picture_size, {floor_ * scale, relative * scale});
        for (std::size_t f = 0; f < worlds_.size(); ++f) {
            std::unique_ptr<renderer::Renderer> learner;
            if (!error_scale) {
                learner = new_renderer(true);
                learner->start_chunk(worlds_[f]);
                // So that trees are no part of the time.
                learner->light(worlds_[f], renderer::Frame{seen_[f].visible, {}, seen_[f].emitted, {}},
                               {map, renderer::LightingMode::rough});
            }
            renderer::Renderer& renderer = error_scale ? *told_[f] : *learner;
            const renderer::Statistics before = renderer.statistics();
            const double start = app::cpu_seconds();
            const core::Radiance cut = renderer.light(worlds_[f], seen_[f], {map}).radiance;
            const renderer::Statistics& after = renderer.statistics();
            sum.seconds += app::cpu_seconds() - start - (after.calibration_seconds - before.calibration_seconds);
            sum.rays += static_cast<double>(after.shadow_rays - before.shadow_rays);
            sum.points += static_cast<double>(after.gather_points - before.gather_points);
            sum.error_scale = error_scale.value_or(after.mean_error_scale);
            for (const renderer::AuditedPixel& p : renderer::compare(seen_[f], pixels_[f], truth_[f], promised, cut))
                sum.errors.push_back(p.noticed() / std::max(p.tolerance, 1e-30f));
        }
        return sum;
    }

  private:
    static app::RenderJob prepared(const std::string& path) {
        app::RenderOptions options;
        options.cache = "off";
        options.input = path;
        options.size = {picture_size, picture_size};
        options.samples = 1;
        options.vpls = vpls;
        app::RenderJob film = app::prepare(options);
        film.rendering.max_cut = 1 << 20;  // the rule alone is to be judged
        film.exposure = film.exposure ? *film.exposure : app::measure_exposure(film);
        return film;
    }

    std::unique_ptr<renderer::Renderer> new_renderer(bool calibrate) const {
        renderer::Settings settings = film_.rendering;
        settings.calibrate = calibrate;
        return std::make_unique<renderer::Renderer>(*film_.animation, settings, film_.plan);
    }

    /// The gather points of some pixels.
    static renderer::Frame only(const renderer::Frame& seen, const std::vector<renderer::LitPixel>& pixels) {
        renderer::Frame part{seen.visible, {}, seen.emitted, {}};
        part.tiles.resize(seen.tiles.size());
        for (const renderer::LitPixel& p : pixels)
            part.tiles[p.tile].insert(part.tiles[p.tile].end(), seen.tiles[p.tile].begin() + p.first,
                                      seen.tiles[p.tile].begin() + p.last);
        return part;
    }

    /// Two blocks of sixteen pixels of every tile: an eighth of the frame.
    static renderer::Frame thinned(renderer::Frame seen) {
        for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
            const int first = static_cast<int>(core::uniform(7, t) * 16);
            std::erase_if(seen.tiles[t], [&](const renderer::GatherPoint& p) {
                const int block = renderer::block_of(p.pixel, renderer::representative_sets);
                return block != first && block != (first + 7) % 16;
            });
        }
        return seen;
    }

    app::RenderJob film_;
    float floor_ = 0;
    std::vector<scene::Snapshot> worlds_;
    std::vector<renderer::Frame> seen_;
    std::vector<std::unique_ptr<renderer::Renderer>> told_;  ///< learn nothing
    std::vector<std::vector<renderer::LitPixel>> pixels_;    ///< that are held against
    std::vector<std::vector<glm::vec3>> truth_;
};

/// A line of what every pixel needs: the error scale with which its error would have been its tolerance.
void list_needs(const std::string& name, double tolerance, double error_scale, const Outcome& lit,
                std::ofstream& needs) {
    needs << fmt::format("{},{:g},{:g}", name, tolerance, error_scale);
    for (const float error : lit.errors) needs << fmt::format(",{:.4g}", error_scale * static_cast<double>(error));
    needs << '\n';
}

void measure(const std::string& name, const std::string& path, std::ofstream& out, std::ofstream& listed) {
    const Bench bench(path);
    for (const double tolerance : tolerances) {
        std::string needs, overs;
        Outcome lawful;
        for (const double error_scale : error_scales) {
            const Outcome o = bench.run(tolerance, 1.0, error_scale);
            needs += fmt::format(" {:.2f}", error_scale * o.quantile(0.99));
            out << fmt::format("{},{:g},{:g},{:.5f},{:.4f},{:.1f}\n", name, tolerance, error_scale, o.over(),
                               o.quantile(0.99), o.rays / o.points);
            list_needs(name, tolerance, error_scale, o, listed);
            if (error_scale == 1.0) lawful = o;
        }
        const Outcome own = bench.run(tolerance, 1.0, std::nullopt);
        out << fmt::format("{},{:g},learnt {:.3f},{:.5f},{:.4f},{:.1f}\n", name, tolerance, own.error_scale, own.over(),
                           own.quantile(0.99), own.rays / own.points);
        fmt::print("| {} | {:g} % |{} | {:.2f} | {:.2f} % | {:.2f} | {:.2f} %; {:.2f}, {:.2f} |\n", name,
                   100 * tolerance, needs, own.error_scale, 100 * own.over(), own.quantile(0.99), 100 * lawful.over(),
                   own.rays / lawful.rays, own.seconds / lawful.seconds);
        std::fflush(stdout);
        out.flush();
    }
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) {
    using namespace render2mpeg;
    try {
        if (argc < 3) throw core::Error("usage: fit_error_calibration OUT.csv NAME=SCENE...");
        const parallel::ThreadLimit limit(1);  // so that CPU seconds are those of the work
        std::ofstream out(argv[1]);
        std::ofstream needs(std::string(argv[1]) + ".needs");
        out << "scene,tolerance,error_scale,over,p99,rays\n";
        fmt::print(
            "| scene | tolerance | r at 99 %, lit at 1, 1/2, 1/4, 1/8 | learnt c | over | p99 of error/T | "
            "at c = 1: over; rays, time of c over it |\n"
            "|---|---|---|---|---|---|---|\n");
        for (int i = 2; i < argc; ++i) {
            const std::string text = argv[i];
            const std::size_t equals = text.find('=');
            if (equals == std::string::npos) throw core::Error(text + ": expected NAME=SCENE");
            measure(text.substr(0, equals), text.substr(equals + 1), out, needs);
        }
        if (!out || !needs) throw core::Error("writing", argv[1], "the file cannot be written");
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
