#include "app/loop/run_statistics.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>

#include "core/numeric.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double clock_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

renderer::Statistics sum_of(const renderer::Statistics& earlier, const renderer::Statistics& later) {
    renderer::Statistics sum = later;
    for (std::uint64_t renderer::Statistics::*count :
         {&renderer::Statistics::gather_rays,      &renderer::Statistics::primary_rays,
          &renderer::Statistics::shadow_rays,      &renderer::Statistics::photon_rays,
          &renderer::Statistics::caustic_rays,     &renderer::Statistics::caustic_photons,
          &renderer::Statistics::caustic_landings, &renderer::Statistics::caustic_pairs,
          &renderer::Statistics::caustic_doubts,   &renderer::Statistics::specular_rays,
          &renderer::Statistics::air_rays,         &renderer::Statistics::exposure_rays,
          &renderer::Statistics::exposed_pixels,   &renderer::Statistics::gather_points,
          &renderer::Statistics::capped_points,    &renderer::Statistics::true_paths,
          &renderer::Statistics::true_pixels,      &renderer::Statistics::capped_pixels,
          &renderer::Statistics::direct_clusters,  &renderer::Statistics::indirect_clusters,
          &renderer::Statistics::non_finite,       &renderer::Statistics::calibrated_pixels,
          &renderer::Statistics::frames_calibrated})
        sum.*count += earlier.*count;
    sum.cache = earlier.cache;
    sum.cache.add(later.cache);
    sum.calibration_seconds += earlier.calibration_seconds;
    sum.sky_seconds += earlier.sky_seconds;
    sum.layer_seconds += earlier.layer_seconds;
    sum.photon_energy += earlier.photon_energy;
    sum.photon_energy_lost += earlier.photon_energy_lost;
    sum.bands.add(earlier.bands);
    if (!earlier.first_non_finite.empty()) sum.first_non_finite = earlier.first_non_finite;

    // What was lit decides whose means count how much; without later frames the earlier ones are all there is.
    const auto frames = static_cast<double>(earlier.frames_calibrated),
               all = static_cast<double>(sum.frames_calibrated);
    sum.mean_error_scale += core::divide_or(frames, all, 0.0) * (earlier.mean_error_scale - later.mean_error_scale);
    sum.largest_error_scale = std::max(earlier.largest_error_scale, later.largest_error_scale);
    if (earlier.frames_calibrated > 0 && later.frames_calibrated > 0)
        sum.least_error_scale = std::min(earlier.least_error_scale, later.least_error_scale);
    else if (earlier.frames_calibrated > 0)
        sum.least_error_scale = earlier.least_error_scale;
    sum.luminance += earlier.luminance;
    sum.clamped_energy = core::divide_or(
        earlier.clamped_energy * earlier.luminance + later.clamped_energy * later.luminance, sum.luminance, 0.0);
    if (later.gather_points == 0) {
        sum.direct_points = earlier.direct_points;
        sum.indirect_points = earlier.indirect_points;
    }
    return sum;
}

RunStatistics sum_of(const RunStatistics& earlier, const RunStatistics& later) {
    RunStatistics sum = earlier;
    for (std::size_t i = 0; i < sum.seconds.size(); ++i) sum.seconds[i] += later.seconds[i];
    for (std::size_t i = 0; i < sum.pass_seconds.size(); ++i) sum.pass_seconds[i] += later.pass_seconds[i];
    sum.earlier_cpu += later.earlier_cpu;
    sum.earlier_wall += later.earlier_wall;
    sum.frames.insert(sum.frames.end(), later.frames.begin(), later.frames.end());
    sum.brightest_luma = std::max(sum.brightest_luma, later.brightest_luma);
    sum.rendering = sum_of(earlier.rendering, later.rendering);
    sum.audit.errors.add(later.audit.errors);
    sum.audit.over += later.audit.over;
    sum.audit.split.add(later.audit.split);
    sum.audit.seconds += later.audit.seconds;
    return sum;
}

RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer) {
    RunStatistics sum = statistics;
    sum.rendering = sum_of(statistics.rendering, renderer.statistics());
    for (std::size_t i = 0; i < sum.pass_seconds.size(); ++i)
        sum.pass_seconds[i] += renderer.seconds(static_cast<renderer::Pass>(i));
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::develop)] =
        sum.stage_seconds(Stage::develop) - sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::glare)];
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::encode)] = sum.stage_seconds(Stage::encode);
    return sum;
}

double RunStatistics::total_seconds() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

double Audit::share_over() const {
    return core::divide_or(static_cast<double>(over), static_cast<double>(errors.count()), 0.0);
}

double RunStatistics::psnr_y() const {
    double sum = 0;
    for (const FrameEntry& entry : frames) sum += entry.mse_y;
    return perceptual::psnr(core::divide_or(sum, static_cast<double>(frames.size()), 0.0));
}

double RunStatistics::ssim_y() const {
    double sum = 0;
    for (const FrameEntry& entry : frames) sum += entry.ssim_y;
    return core::divide_or(sum, static_cast<double>(frames.size()), 1.0);
}

std::optional<double> RunStatistics::pumping() const {
    double squares = 0, pictures = 0;
    for (const FrameEntry& entry : frames)
        if (entry.pumping >= 0) {
            squares += entry.pumping * entry.pumping;
            ++pictures;
        }
    if (pictures == 0) return std::nullopt;
    return std::sqrt(squares / pictures);
}

RateOutcome RunStatistics::rate_outcome() const {
    RateOutcome outcome;
    for (const FrameEntry& entry : frames) {
        outcome.bytes += entry.bytes;
        outcome.stuffing += entry.stuffing;
        outcome.requantised += entry.tries > 1 ? 1 : 0;
        outcome.minimal += entry.minimal ? 1 : 0;
        outcome.off_plan += entry.quantiser != entry.planned_quantiser ? 1 : 0;
    }
    return outcome;
}

QuantiserRange RunStatistics::quantisers() const {
    QuantiserRange range;
    for (const FrameEntry& entry : frames) {
        range.mean += entry.mean_quantiser;
        range.min = range.min == 0 ? entry.quantiser : std::min(range.min, entry.quantiser);
        range.max = std::max(range.max, entry.quantiser);
        range.finest += entry.quantiser == 1 ? 1 : 0;
        range.coarsest += entry.quantiser == 31 ? 1 : 0;
    }
    range.mean = core::divide_or(range.mean, static_cast<double>(frames.size()), 0.0);
    return range;
}

double RunStatistics::mean_direct_cut() const {
    return core::divide_or(static_cast<double>(rendering.direct_clusters), static_cast<double>(rendering.gather_points),
                           0.0);
}

double RunStatistics::mean_indirect_cut() const {
    return core::divide_or(static_cast<double>(rendering.indirect_clusters),
                           static_cast<double>(rendering.gather_points), 0.0);
}

}  // namespace render2mpeg::app
