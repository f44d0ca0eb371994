#include "renderer/truth/pixel_truth.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Paths of a pilot, and the fewest of a batch: rare light that the pilot missed must not pass for none.
constexpr std::uint64_t pilot_paths = 256, least_paths = 32;

/// Paths of each batch that the pilot's spread asks for.
std::uint64_t paths_of_batch(const PathSums& pilot, const TruthRequest& r, const TruthSettings& settings) {
    const auto n = static_cast<double>(pilot_paths);
    const double mean = glm::dot(glm::dvec3(core::luminance_weights), pilot.whole) / n;
    double variance = std::max(pilot.squares / n - mean * mean, 0.0) * n / (n - 1);
    // Much less than expected: some light is so rare that the pilot missed it.
    const double missing = static_cast<double>(r.luminance) - mean;
    if (2 * missing > static_cast<double>(r.luminance)) variance = std::max(variance, n * missing * missing);
    const double error = static_cast<double>(settings.relative_error) * static_cast<double>(r.luminance);
    const auto least = static_cast<double>(least_paths),
               most = std::max(least, static_cast<double>(settings.most_paths / truth_batches));
    const double wanted =
        variance > 0.0 ? core::divide_or(variance, error * error * static_cast<double>(truth_batches), most) : least;
    return static_cast<std::uint64_t>(std::clamp(std::ceil(wanted), least, most));
}

}  // namespace

std::vector<PixelTruth> pixel_truth(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan,
                                    std::span<const TruthRequest> requests, const TruthSettings& settings) {
    const PixelPaths pixel_paths(posed_scene, see, plan);
    const std::int64_t frame = posed_scene.posed().frame;
    std::vector<std::uint64_t> paths(requests.size());
    std::vector<glm::dvec3> shown(requests.size());
    parallel::for_each(requests.size(), [&](std::size_t i) {
        const PathSums pilot = pixel_paths.follow(
            requests[i], numbers_of_batch(settings.seed, frame, requests[i].place, truth_batches), pilot_paths);
        paths[i] = paths_of_batch(pilot, requests[i], settings);
        const glm::vec3 sum = pixel_paths.shown_by_pattern(requests[i]);
        shown[i] = core::is_finite(sum) ? glm::dvec3(sum) : glm::dvec3(0);
    });
    using Means = std::array<glm::dvec3, truth_batches>;
    std::vector<Means> at_points(requests.size()), whole(requests.size());
    parallel::for_each(requests.size() * truth_batches, [&](std::size_t k) {
        const std::size_t i = k / truth_batches, b = k % truth_batches;
        const PathSums sums =
            pixel_paths.follow(requests[i], numbers_of_batch(settings.seed, frame, requests[i].place, b), paths[i]);
        at_points[i][b] = sums.at_points / static_cast<double>(paths[i]);
        whole[i][b] = sums.whole / static_cast<double>(paths[i]);
    });
    std::vector<PixelTruth> truth;
    for (std::size_t i = 0; i < requests.size(); ++i)
        truth.push_back(
            {estimate_of(at_points[i], shown[i]), estimate_of(whole[i], glm::dvec3(0)), truth_batches * paths[i]});
    return truth;
}

}  // namespace render2mpeg::renderer
