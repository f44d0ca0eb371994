// The fit of the stopping rule (docs/measurements.md#stopping-rule): how many pixels of real pictures err by more than
// their tolerance, at a range of factors on what a cut is thought to err by, against the sum over all light points.
//
//   stopping_rule OUT.csv NAME=SCENE[:apart]...
//
// writes what was measured and prints the tables of the document. Scenes marked `apart` take no part in the fit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "app/job/automatic_exposure.h"
#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/color.h"
#include "core/error.h"
#include "core/sampling.h"
#include "parallel/loops.h"

namespace render2mpeg {
namespace {

constexpr int picture_size = 512, vpls = 9000, frames_per_scene = 2;
/// Every so many tiles of 16x16 one block of 4x4 pixels is looked at: some 1,000 pixels a frame in 64 places, since
/// errors come in patches.
constexpr int tile_step = 16;
constexpr double promise = 0.01;  ///< share of pixels that may exceed their tolerance
const std::vector<double> tolerances{0.01, 0.02, 0.04, 0.08, 0.26};
const std::vector<double> tried_factors{0.35, 0.5, 0.7, 1.0, 1.4};

struct Subject {
    std::string name, path;
    bool apart = false;
};

/// One cut of all chosen pixels.
struct Measured {
    double over = 0, capped = 0;  ///< share of pixels beyond their tolerance; of points stopped by the largest cut
    double colour99 = 0;
    double p50 = 0, p95 = 0, p99 = 0;            ///< of error over tolerance
    double rays = 0, clusters = 0, seconds = 0;  ///< per gather point; seconds summed
    double pixels = 0;
};

struct Key {
    std::string name;
    double tolerance = 0, factor = 0;
    auto operator<=>(const Key&) const = default;
};
using Results = std::map<Key, Measured>;

/// Leaves one 4x4 block of every `tile_step`th tile and lists its pixels that have something to gather.
std::vector<glm::ivec2> thin_out(renderer::Frame& seen) {
    std::vector<glm::ivec2> pixels;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        const int tile_x = static_cast<int>(t) % seen.tiles_across(),
                  tile_y = static_cast<int>(t) / seen.tiles_across();
        const int block = static_cast<int>(core::uniform(7, t) * 16);
        renderer::GatherTile kept;
        for (const renderer::GatherPoint& p : seen.tiles[t]) {
            const int x = p.pixel % renderer::tile_size, y = p.pixel / renderer::tile_size;
            if (t % tile_step != static_cast<std::size_t>(tile_y) % tile_step || y / 4 * 4 + x / 4 != block) continue;
            const glm::ivec2 pixel(tile_x * renderer::tile_size + x, tile_y * renderer::tile_size + y);
            if (pixels.empty() || pixels.back() != pixel) pixels.push_back(pixel);
            kept.push_back(p);
        }
        seen.tiles[t] = std::move(kept);
    }
    return pixels;
}

class Bench {
  public:
    Bench(const Subject& subject, int frame_index) : film_(prepared(subject)) {
        film_.exposure = film_.exposure ? *film_.exposure : app::measure_exposure(film_);
        // Below half a code value above black nobody sees a difference.
        const perceptual::Display display(*film_.exposure, perceptual::matrix_for(picture_size));
        floor_ = core::luminance(display.with_luma(glm::vec3(1), 16.5f));
        const std::int64_t frame =
            film_.frames.first + film_.frame_count() * (2 * frame_index + 1) / (2 * frames_per_scene);
        world_.emplace(film_.snapshot(frame));
        renderer_.emplace(*film_.animation, film_.rendering, film_.plan);
        renderer_->start_chunk(*world_);
        seen_ = renderer_->look(*world_);
        pixels_ = thin_out(seen_);
        truth_ = colors(core::ToleranceMap::reference());
    }

    /// Adds the shares, weighted by pixels, to `sum`.
    void add(double tolerance, double factor, Measured& sum) {
        const renderer::Statistics before = renderer_->statistics();
        const double start = app::cpu_seconds();
        // An error counts `factor` times.
        const auto relative = static_cast<float>(tolerance / factor), floor = static_cast<float>(floor_ / factor);
        const std::vector<glm::dvec3> found =
            colors(core::ToleranceMap::uniform(picture_size, picture_size, {floor, relative}));
        const double seconds = app::cpu_seconds() - start;
        std::vector<double> errors, colours;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double allowed = std::max<double>(floor_, tolerance * luminance(truth_[i]));
            const glm::dvec3 error = found[i] - truth_[i];
            const double luma = luminance(error);
            errors.push_back(std::abs(luma) / allowed);
            // Cb and Cr of linear light [BT709, 3.3].
            colours.push_back(std::max(std::abs(error.z - luma) / 1.8556, std::abs(error.x - luma) / 1.5748) / allowed);
        }
        std::sort(errors.begin(), errors.end());
        std::sort(colours.begin(), colours.end());
        const auto n = static_cast<double>(errors.size());
        const auto quantile = [&](double q) { return errors[static_cast<std::size_t>(q * (n - 1))]; };
        const renderer::Statistics& after = renderer_->statistics();
        const auto points = static_cast<double>(after.gather_points - before.gather_points);
        const auto part = [&](double& mean, double value) {
            mean = (mean * sum.pixels + value * n) / (sum.pixels + n);
        };
        part(sum.over, static_cast<double>(errors.end() - std::upper_bound(errors.begin(), errors.end(), 1.0)) / n);
        part(sum.p50, quantile(0.5));
        part(sum.p95, quantile(0.95));
        part(sum.p99, quantile(0.99));
        part(sum.colour99, colours[static_cast<std::size_t>(0.99 * (n - 1))]);
        part(sum.capped, static_cast<double>(after.capped_points - before.capped_points) / points);
        part(sum.rays, static_cast<double>(after.shadow_rays - before.shadow_rays) / points);
        part(sum.clusters, static_cast<double>(after.direct_clusters + after.indirect_clusters -
                                               before.direct_clusters - before.indirect_clusters) /
                               points);
        part(sum.seconds, 1e6 * seconds / points);
        sum.pixels += n;
    }

  private:
    static app::RenderJob prepared(const Subject& subject) {
        app::RenderOptions options;
        options.cache = "off";
        options.input = subject.path;
        options.size = {picture_size, picture_size};
        options.samples = 1;
        options.vpls = vpls;
        app::RenderJob film = app::prepare(options);
        film.rendering.max_cut = 1 << 20;  // the rule alone is to be judged
        film.rendering.calibrate = false;
        return film;
    }

    static double luminance(glm::dvec3 c) { return glm::dot(glm::dvec3(core::luminance_weights), c); }
    std::vector<glm::dvec3> colors(const core::ToleranceMap& tolerance) {
        const core::Radiance radiance = renderer_->light(*world_, seen_, {tolerance}).radiance;
        std::vector<glm::dvec3> values;
        for (const glm::ivec2 p : pixels_) values.push_back(radiance.combined.at(p.x, p.y));
        return values;
    }

    app::RenderJob film_;
    float floor_ = 0;
    std::optional<scene::Snapshot> world_;
    std::optional<renderer::Renderer> renderer_;
    renderer::Frame seen_;
    std::vector<glm::ivec2> pixels_;
    std::vector<glm::dvec3> truth_;
};

void measure(const Subject& subject, Results& results) {
    for (int frame = 0; frame < frames_per_scene; ++frame) {
        Bench bench(subject, frame);
        for (const double tolerance : tolerances)
            for (const double factor : tried_factors)
                bench.add(tolerance, factor, results[{subject.name, tolerance, factor}]);
    }
}

/// The value of `read` at a factor between those measured, linear over the factor's logarithm.
template <class Read>
double at_factor(const Results& results, Key key, const std::vector<double>& factors, double factor, Read read) {
    std::size_t i = 1;
    while (i + 1 < factors.size() && factors[i] < factor) ++i;
    key.factor = factors[i - 1];
    const double a = read(results.at(key));
    key.factor = factors[i];
    const double b = read(results.at(key));
    const double t = std::log(factor / factors[i - 1]) / std::log(factors[i] / factors[i - 1]);
    return a + (b - a) * std::clamp(t, 0.0, 1.0);
}

/// The least factor at which the promise is kept, and at every larger one.
double needed(const Results& results, const Key& key, const std::vector<double>& factors) {
    const auto over = [&](double factor) {
        return at_factor(results, key, factors, factor, [](const Measured& m) { return m.over; });
    };
    double least = factors.back();
    for (double f = factors.back(); f >= factors.front(); f *= 0.99) {
        if (over(f) > promise) break;
        least = f;
    }
    return least;
}

void print_shares(const std::vector<Subject>& subjects, const Results& results) {
    fmt::print(
        "| scene | tolerance | over | p50 / p95 / p99; colour p99 | clusters | rays | factor needed |\n"
        "|---|---|---|---|---|---|---|\n");
    for (const Subject& s : subjects) {
        for (const double t : tolerances) {
            const Measured& m = results.at({s.name, t, 1.0});
            fmt::print("| {}{} | {:g} % | {:.2f} % | {:.2f} / {:.2f} / {:.2f}; {:.2f} | {:.0f} | {:.0f} | {:.2f} |\n",
                       s.name, s.apart ? " (apart)" : "", 100 * t, 100 * m.over, m.p50, m.p95, m.p99, m.colour99,
                       m.clusters, m.rays, needed(results, {s.name, t, 0}, tried_factors));
        }
    }
}

/// What each scene would err by, had the factor been fitted on the others of the fit alone: their worst need.
void print_cross_validation(const std::vector<Subject>& subjects, const Results& results) {
    fmt::print("\n| left out | over at");
    for (const double t : tolerances) fmt::print(" {:g} %", 100 * t);
    fmt::print(" |\n|---|---|\n");
    for (const Subject& left : subjects) {
        fmt::print("| {}{} |", left.name, left.apart ? " (apart)" : "");
        for (const double t : tolerances) {
            // The factor may differ between tolerances, as k does.
            double worst = 0;
            for (const Subject& other : subjects)
                if (!other.apart && other.name != left.name)
                    worst = std::max(worst, needed(results, {other.name, t, 0}, tried_factors));
            fmt::print(" {:.2f}", 100 * at_factor(results, {left.name, t, 0}, tried_factors, worst,
                                                  [](const Measured& m) { return m.over; }));
        }
        fmt::print(" |\n");
    }
}

void print_needs(const std::vector<Subject>& subjects, const Results& results) {
    fmt::print("\n| tolerance | largest factor needed, fit | apart |\n|---|---|---|\n");
    for (const double t : tolerances) {
        double worst[2] = {};
        for (const Subject& s : subjects) {
            double& w = worst[static_cast<int>(s.apart)];
            w = std::max(w, needed(results, {s.name, t, 0}, tried_factors));
        }
        fmt::print("| {:g} % | {:.2f} | {:.2f} |\n", 100 * t, worst[0], worst[1]);
    }
}

void write_csv(const std::string& file, const Results& results) {
    std::ofstream out(file);
    out << "scene,tolerance,factor,pixels,over,capped,p50,p95,p99,colour99,clusters,rays,microseconds\n";
    for (const auto& [key, m] : results)
        out << fmt::format("{},{:g},{:g},{:.0f},{:.5f},{:.5f},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.1f}\n",
                           key.name, key.tolerance, key.factor, m.pixels, m.over, m.capped, m.p50, m.p95, m.p99,
                           m.colour99, m.clusters, m.rays, m.seconds);
    if (!out) throw core::Error("writing", file, "the file cannot be written");
}

int run(int argc, char** argv) {
    if (argc < 3) throw core::Error("usage: stopping_rule OUT.csv NAME=SCENE[:apart]...");
    std::vector<Subject> subjects;
    for (int i = 2; i < argc; ++i) {
        std::string text = argv[i];
        Subject s;
        s.apart = text.ends_with(":apart");
        if (s.apart) text.resize(text.size() - 6);
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) throw core::Error(text + ": expected NAME=SCENE[:apart]");
        s.name = text.substr(0, equals);
        s.path = text.substr(equals + 1);
        subjects.push_back(s);
    }
    const parallel::ThreadLimit limit(1);  // so that CPU seconds are those of the work
    Results results;
    for (const Subject& s : subjects) {
        std::fprintf(stderr, "%s\n", s.name.c_str());
        measure(s, results);
        write_csv(argv[1], results);
    }
    print_shares(subjects, results);
    print_needs(subjects, results);
    print_cross_validation(subjects, results);
    return 0;
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) {
    try {
        return render2mpeg::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
