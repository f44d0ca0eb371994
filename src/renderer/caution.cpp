#include "renderer/caution.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// fit: docs/fits/caution
constexpr std::size_t window = 2048;   ///< pixels that are remembered
constexpr float aimed_share = 0.005f;  ///< of pixels beyond their tolerance, where 0.01 is promised
/// The largest of few pixels is not rare enough. chosen: 144 pixels in two rounds get 1.22, 1024 get 1.03; at 1.11
/// and 1.03 two of four rooms of 96x96 pixels had 1.2 % beyond their tolerance.
constexpr float few_pixels_margin = 64.0f;
/// chosen: films need 0.25 to 1.3; beyond lie only films that show nothing of their light yet, and faults.
constexpr float least = 0.1f, most = 2.0f;
constexpr float step = 1.03f;
/// How far what is needed may leave the value held, upward and downward: the quantile of 2048 pixels scatters by 6 %
/// where errors have an exponential's tail. fit: docs/fits/caution
constexpr float held_above = 1.06f, held_below = 0.84f;

float next_step(float value) {
    return std::min(std::pow(step, std::round(std::log(value) / std::log(step))), most);
}

}  // namespace

void Caution::forget() {
    needed_.clear();
    next_ = 0;
    settle();
}

void Caution::settle() {
    const float wanted = needed();
    holds_ = wanted > 0.0f;
    value_ = holds_ ? next_step(wanted) : 1.0f;
}

float Caution::needed() const {
    if (!knows()) return 0.0f;
    // The ceil((n + 1)(1 - a))-th smallest.
    std::vector<float> sorted = needed_;
    const auto n = static_cast<double>(sorted.size());
    const auto place = std::min(sorted.size(), static_cast<std::size_t>(std::ceil((n + 1.0) * (1.0 - aimed_share))));
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(place - 1);
    std::nth_element(sorted.begin(), nth, sorted.end());
    return std::clamp(*nth * (1.0f + few_pixels_margin / static_cast<float>(n)), least, most);
}

void Caution::learn(std::span<const AuditedPixel> pixels, float caution) {
    for (const AuditedPixel& p : pixels) {
        if (p.capped || !(p.luminance > 0.0f || p.error > 0.0f)) continue;
        const float needed = caution * core::divide_or(p.noticed(), p.tolerance, p.noticed() > 0.0f ? most : 0.0f);
        if (needed_.size() < window)
            needed_.push_back(needed);
        else
            needed_[next_] = needed;
        next_ = (next_ + 1) % window;
    }
    const float wanted = needed();
    if (!holds_ || wanted > held_above * value_ || wanted < held_below * value_) settle();
}

}  // namespace render2mpeg::renderer
