#include "app/experiments/bd_rate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace render2mpeg::app {

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

}  // namespace render2mpeg::app
