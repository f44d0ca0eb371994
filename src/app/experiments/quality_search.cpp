#include "app/experiments/quality_search.h"

#include <algorithm>
#include <limits>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Largest step beyond the known range. chosen: twice a quantiser's doubling; slopes differ from film to film by half
/// (20..60).
constexpr double farthest = 40;

double in_steps(double quality) {
    return std::clamp(std::round(quality / QualitySearch::step) * QualitySearch::step, 0.0, 100.0);
}

/// Crossing of a rising curve with `target` between two neighbours.
double crossing(const std::vector<QualitySearch::Known>& points, std::size_t upper, double target) {
    std::vector<double> x, y;
    for (const QualitySearch::Known& p : points) x.push_back(p.quality), y.push_back(p.figure);
    const Pchip curve(x, y);
    double low = x[upper - 1], high = x[upper];
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (curve.at(middle) < target ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

double bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test) {
    const auto curve = [](std::vector<RatePoint>& points) {
        std::sort(points.begin(), points.end(), [](const RatePoint& a, const RatePoint& b) { return a.psnr < b.psnr; });
        std::vector<double> x, y;
        for (const RatePoint& p : points) {
            // Of points of equal quality the cheapest counts.
            if (!x.empty() && p.psnr == x.back()) {
                y.back() = std::min(y.back(), std::log(p.bits));
                continue;
            }
            x.push_back(p.psnr);
            y.push_back(std::log(p.bits));
        }
        return std::pair(x, y);
    };
    const auto [anchor_x, anchor_y] = curve(anchor);
    const auto [test_x, test_y] = curve(test);
    if (anchor_x.size() < 2 || test_x.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    const Pchip a(anchor_x, anchor_y), b(test_x, test_y);
    const double low = std::max(anchor.front().psnr, test.front().psnr),
                 high = std::min(anchor.back().psnr, test.back().psnr);
    if (!(low < high)) return std::numeric_limits<double>::quiet_NaN();
    constexpr int steps = 1000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double x = low + (high - low) * (i + 0.5) / steps;
        sum += b.at(x) - a.at(x);
    }
    return 100 * (std::exp(sum / steps) - 1);
}

void QualitySearch::add(double quality, double figure) {
    const auto place = std::lower_bound(known_.begin(), known_.end(), quality - 0.5 * step,
                                        [](const Known& k, double q) { return k.quality < q; });
    if (place != known_.end() && std::abs(place->quality - quality) < 0.5 * step)
        *place = {quality, figure};
    else
        known_.insert(place, {quality, figure});
}

std::optional<double> QualitySearch::next() const {
    if (known_.empty()) return std::nullopt;
    const auto upper = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.figure >= target_; });

    // Extrapolate along the last two points, or the usual slope.
    if (upper == known_.end() || upper == known_.begin()) {
        const Known& end = upper == known_.end() ? known_.back() : known_.front();
        const double bound = upper == known_.end() ? 100 : 0;
        if (std::abs(end.quality - bound) < 0.5 * step) return std::nullopt;
        double slope = slope_;
        if (known_.size() > 1) {
            const Known& beside = upper == known_.end() ? known_[known_.size() - 2] : known_[1];
            const double rise = (end.figure - beside.figure) / (end.quality - beside.quality);
            slope = std::clamp(rise, 0.2 * slope_, 5 * slope_);
        }
        // A second step beyond covers at least half of the rest, a third one all of it.
        const double left = bound - end.quality;
        const double least = known_.size() > 3 ? std::abs(left) : known_.size() > 2 ? 0.5 * std::abs(left) : 1;
        const double way = std::clamp(std::abs(target_ - end.figure) / slope, std::min(least, farthest), farthest);
        return in_steps(end.quality + std::copysign(known_.size() > 3 ? std::abs(left) : way, left));
    }

    // Interpolate, not too near to either end, and by halves in the end.
    const auto index = static_cast<std::size_t>(upper - known_.begin());
    const double low = known_[index - 1].quality, high = upper->quality, width = high - low;
    if (width < 1.5 * step) return std::nullopt;
    // chosen: five probes tell whether the film follows a curve at all (4..8).
    double at = known_.size() > 5 ? 0.5 * (low + high) : crossing(known_, index, target_);
    at = in_steps(std::clamp(at, low + 0.1 * width, high - 0.1 * width));
    if (at <= low + 0.5 * step) at = in_steps(low + step);
    if (at >= high - 0.5 * step) at = in_steps(high - step);
    return at;
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
