#include "renderer/truth/true_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Paths of a pixel's pilot, of which nine tell a pixel's number, and the fewest of a batch.
constexpr std::uint64_t frame_pilot_paths = 32, least_batch = 8;

/// Luminance that errors are shares of at least, over the frame's mean. chosen: 1 %, some two code values of a picture
/// whose mean is mid grey.
constexpr double darkest = 0.01;

/// Result of a pilot.
struct Pilot {
    double mean = 0, variance = 0;  ///< of one path's luminance
};

Pilot pilot_of(const PixelPaths& paths, const TruthRequest& request, const Stream& batch) {
    const PathSums sums = paths.follow(request, batch, frame_pilot_paths);
    constexpr auto n = static_cast<double>(frame_pilot_paths);
    const double mean = glm::dot(glm::dvec3(core::luminance_weights), sums.whole) / n;
    return {mean, std::max(sums.squares / n - mean * mean, 0.0) * n / (n - 1)};
}

/// The mean of the pilots of a pixel and its neighbours: light that one of them met may shine on all.
Pilot about(const core::Plane<Pilot>& pilots, int x, int y) {
    Pilot sum;
    double count = 0, squares = 0;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, pilots.height() - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, pilots.width() - 1); ++u) {
            const Pilot& p = pilots.at(u, v);
            sum.mean += p.mean;
            squares += p.variance;
            count += 1;
        }
    // Its own, where an edge runs beside it, is the safer one.
    return {sum.mean / count, std::max(squares / count, pilots.at(x, y).variance)};
}

/// Paths of each of a pixel's batches.
std::uint64_t paths_by(const Pilot& pilot, double luminance, const TruthSettings& settings) {
    const double error = static_cast<double>(settings.relative_error) * luminance;
    const auto most = std::max(least_batch, settings.most_paths / truth_batches);
    const double wanted = core::divide_or(pilot.variance, error * error * static_cast<double>(truth_batches), 0.0);
    return static_cast<std::uint64_t>(
        std::clamp(std::ceil(wanted), static_cast<double>(least_batch), static_cast<double>(most)));
}

}  // namespace

TrueFrame true_frame(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan,
                     const core::Plane<glm::vec3>& known, const TruthSettings& settings) {
    const PixelPaths pixel_paths(posed_scene, see, plan);
    const std::int64_t frame = posed_scene.posed().frame;
    const int width = known.width(), height = known.height();
    const auto request_of = [&](std::size_t i) {
        TruthRequest r;
        r.place = {static_cast<int>(i) % width, static_cast<int>(i) / width};
        r.known = known.values()[i];
        return r;
    };
    const auto batch_of = [&](const TruthRequest& r, std::uint64_t batch) {
        return numbers_of_batch(settings.seed, frame, r.place, batch);
    };

    // Ask a few paths everywhere, which are thrown away.
    core::Plane<Pilot> pilots(width, height);
    parallel::for_each(known.size(), [&](std::size_t i) {
        const TruthRequest r = request_of(i);
        pilots.values()[i] = pilot_of(pixel_paths, r, batch_of(r, truth_batches));
    });
    double light = 0;
    for (const Pilot& p : pilots.values()) light += p.mean;
    const double floor = darkest * light / static_cast<double>(known.size());

    TrueFrame truth;
    core::Radiance& radiance = truth.radiance;
    radiance.frame = frame;
    radiance.combined = radiance.half = core::Plane<glm::vec3>(width, height, glm::vec3(0));
    radiance.error = core::Plane<float>(width, height, 0);
    radiance.capped = core::Plane<std::uint8_t>(width, height, 0);
    core::Plane<std::uint64_t> paths(width, height, 0);
    parallel::for_each(known.size(), [&](std::size_t i) {
        const TruthRequest r = request_of(i);
        const Pilot pilot = about(pilots, r.place.x, r.place.y);
        const std::uint64_t count = paths_by(pilot, std::max(pilot.mean, floor), settings);
        std::array<glm::dvec3, truth_batches> means;
        for (std::uint64_t b = 0; b < truth_batches; ++b)
            means[b] = pixel_paths.follow(r, batch_of(r, b), count).whole / static_cast<double>(count);
        const Estimate e = estimate_of(means, glm::dvec3(0));
        radiance.combined.values()[i] = glm::vec3(e.mean());
        radiance.half.values()[i] = glm::vec3(e.halves[0]);
        radiance.error.values()[i] = static_cast<float>(std::sqrt(e.variance));
        radiance.capped.values()[i] = truth_batches * count >= settings.most_paths ? 1 : 0;
        paths.values()[i] = frame_pilot_paths + truth_batches * count;
    });
    for (std::size_t i = 0; i < known.size(); ++i) {
        truth.paths += paths.values()[i];
        truth.capped += radiance.capped.values()[i];
    }
    return truth;
}

}  // namespace render2mpeg::renderer
