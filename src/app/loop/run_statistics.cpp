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
