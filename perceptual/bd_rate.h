#pragma once
// Bjontegaard's mean difference of rate.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace render2mpeg::perceptual {

struct RatePoint {
    double bits = 0;  ///< > 0; or any other cost
    double psnr = 0;  ///< dB; or any other quality that grows
};

/// Monotone piecewise cubic through points of rising x. [Fritsch1980]
class Pchip {
  public:
    Pchip(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)), slope_(x_.size()) {
        const std::size_t n = x_.size();
        std::vector<double> h(n - 1), d(n - 1);
        for (std::size_t i = 0; i + 1 < n; ++i) {
            h[i] = x_[i + 1] - x_[i];
            d[i] = (y_[i + 1] - y_[i]) / h[i];
        }
        for (std::size_t i = 1; i + 1 < n; ++i) {
            if (d[i - 1] * d[i] <= 0) continue;
            const double a = 2 * h[i] + h[i - 1], b = h[i] + 2 * h[i - 1];
            slope_[i] = (a + b) / (a / d[i - 1] + b / d[i]);
        }
        slope_[0] = end_slope(h[0], n > 2 ? h[1] : h[0], d[0], n > 2 ? d[1] : d[0]);
        slope_[n - 1] = end_slope(h[n - 2], n > 2 ? h[n - 3] : h[n - 2], d[n - 2], n > 2 ? d[n - 3] : d[n - 2]);
    }

    double at(double x) const {
        std::size_t i = 0;
        while (i + 2 < x_.size() && x > x_[i + 1]) ++i;
        const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h;
        return y_[i] * (1 + 2 * t) * (1 - t) * (1 - t) + h * slope_[i] * t * (1 - t) * (1 - t) +
               y_[i + 1] * t * t * (3 - 2 * t) + h * slope_[i + 1] * t * t * (t - 1);
    }

  private:
    static double end_slope(double h0, double h1, double d0, double d1) {
        const double s = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
        if (s * d0 <= 0) return 0;
        return d0 * d1 <= 0 && std::abs(s) > 3 * std::abs(d0) ? 3 * d0 : s;
    }
    std::vector<double> x_, y_, slope_;
};

/// Mean difference of rate at equal quality, per cent, over the common qualities; negative: `test` needs fewer bits.
/// NaN without common quality or with fewer than two points. [Bjontegaard2001] with piecewise cubics of log rate.
inline double bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test) {
    const auto curve = [](std::vector<RatePoint>& points) {
        std::ranges::sort(points, {}, &RatePoint::psnr);
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

}  // namespace render2mpeg::perceptual
