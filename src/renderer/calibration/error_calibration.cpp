#include "renderer/calibration/error_calibration.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// fit: docs/measurements.md#error-scale
constexpr std::size_t window = 2048;      ///< pixels that are remembered
constexpr double promised_share = 0.01;   ///< of pixels beyond their tolerance
constexpr double aimed_share = 0.005;     ///< of pixels, so that chunks scatter about it within the promise
constexpr double tail_share = 0.05;       ///< of pixels that say how what is needed thins out
constexpr std::size_t least_tail = 12;    ///< as many at least
constexpr double few_pixels_margin = 64;  ///< few pixels know little of their tail: 144 get 1.44, 1024 get 1.06
/// chosen: films need 0.25 to 1.3; beyond lie only films that show nothing of their light yet, and faults.
constexpr float least = 0.1f, most = 2.0f;
constexpr float step = 1.03f;
/// How far what is needed may leave the value held, upward and downward: the tail of 2048 pixels scatters by 5 %
/// where errors have an exponential's tail. fit: docs/measurements.md#error-scale
constexpr float held_above = 1.06f, held_below = 0.84f;

float next_step(float value) {
    return std::min(std::pow(step, std::round(std::log(value) / std::log(step))), most);
}

/// Quantile exceeded by a share of `aimed_share`, if the excess over a high threshold is exponential [Pickands1975]:
/// all pixels of the tail count, so it scatters less than the one pixel at that place. `falling`: the largest in
/// falling order, those of the tail and one more, of n.
double tail_quantile(std::span<const float> falling, double n) {
    const auto tail = static_cast<double>(falling.size() - 1);
    double excess = 0;
    for (const float r : falling) excess += static_cast<double>(r - falling.back());
    return static_cast<double>(falling.back()) + excess / tail * std::log(tail / (aimed_share * n));
}

}  // namespace

void ErrorCalibration::forget() {
    needed_.clear();
    next_ = 0;
    settle();
}

void ErrorCalibration::settle() {
    const float wanted = needed();
    holds_ = wanted > 0.0f;
    value_ = holds_ ? next_step(wanted) : 1.0f;
}

float ErrorCalibration::needed() const {
    if (!knows()) return 0.0f;
    std::vector<float> falling = needed_;
    const auto n = static_cast<double>(falling.size());
    const std::size_t tail = std::max(least_tail, static_cast<std::size_t>(tail_share * n));
    std::partial_sort(falling.begin(), falling.begin() + static_cast<std::ptrdiff_t>(tail + 1), falling.end(),
                      std::greater<>());
    falling.resize(tail + 1);
    // The ceil((n + 1)(1 - a))-th smallest, counted from above: keeps the promise whatever the tail [Lei2018, 2.2].
    const auto place = static_cast<std::size_t>(n - std::min(n, std::ceil((n + 1.0) * (1.0 - promised_share))));
    const double aimed = tail_quantile(falling, n) * (1.0 + few_pixels_margin / n);
    return std::clamp(static_cast<float>(std::max(aimed, static_cast<double>(falling[place]))), least, most);
}

void ErrorCalibration::learn(std::span<const AuditedPixel> pixels, float error_scale) {
    for (const AuditedPixel& p : pixels) {
        if (p.capped || !(p.luminance > 0.0f || p.error > 0.0f)) continue;
        // At most what an error scale may be, so that a single fault does not decide the mean of a tail.
        const float needed =
            std::min(error_scale * core::divide_or(p.noticed(), p.tolerance, p.noticed() > 0.0f ? most : 0.0f), most);
        if (!std::isfinite(needed)) continue;
        if (needed_.size() < window)
            needed_.push_back(needed);
        else
            needed_[next_ % needed_.size()] = needed;
        next_ = (next_ + 1) % window;
    }
    const float wanted = needed();
    if (!holds_ || wanted > held_above * value_ || wanted < held_below * value_) settle();
}

}  // namespace render2mpeg::renderer
