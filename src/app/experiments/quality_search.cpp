#include "app/experiments/quality_search.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::app {

void QualitySearch::add(double quality, double figure) {
    const auto place =
        std::lower_bound(known_.begin(), known_.end(), quality, [](const Known& k, double q) { return k.quality < q; });
    known_.insert(place, {quality, figure});
}

std::optional<double> QualitySearch::next() const {
    if (known_.empty()) return std::nullopt;
    const auto in_steps = [](double quality) { return std::round(quality / step) * step; };
    const auto upper = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.figure >= target_; });
    if (upper == known_.end() || upper == known_.begin()) {
        const double end = upper == known_.end() ? known_.back().quality : known_.front().quality;
        const double bound = upper == known_.end() ? 100 : 0;
        if (std::abs(end - bound) < 0.5 * step) return std::nullopt;
        // Half of the rest, then all of it.
        return known_.size() > 1 ? bound : in_steps(0.5 * (end + bound));
    }
    const Known &low = *std::prev(upper), &high = *upper;
    const double width = high.quality - low.quality;
    if (width < 1.5 * step) return std::nullopt;
    // chosen: four probes tell whether the film follows a line (3..6); not too near to either end.
    const double share = known_.size() > 4 ? 0.5 : (target_ - low.figure) / (high.figure - low.figure);
    const double at = in_steps(low.quality + std::clamp(share, 0.1, 0.9) * width);
    return std::clamp(at, low.quality + step, high.quality - step);
}

const QualitySearch::Known& QualitySearch::nearest() const {
    EXPECTS(!known_.empty());
    return *std::min_element(known_.begin(), known_.end(), [&](const Known& a, const Known& b) {
        return std::abs(a.figure - target_) < std::abs(b.figure - target_);
    });
}

std::optional<QualitySearch::Known> QualitySearch::coarsest_above() const {
    for (const Known& k : known_)
        if (k.figure >= target_) return k;
    return std::nullopt;
}

std::optional<QualitySearch::Known> QualitySearch::finest_below() const {
    for (auto k = known_.rbegin(); k != known_.rend(); ++k)
        if (k->figure <= target_) return *k;
    return std::nullopt;
}

}  // namespace render2mpeg::app
