#include "image/halve.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace render2mpeg::image {
namespace {

/// What one texel of the shorter row is made of.
struct Mixture {
    std::vector<int> from;
    std::vector<float> weight;  ///< sums to 1
};

/// Integral from -infinity to x of the filter: a tent of unit half width. chosen: against a box, a quadratic B-spline
/// and Kaiser windows (docs/fits/pictures.md).
double tent_integral(double x) {
    if (x <= -1) return 0;
    if (x >= 1) return 1;
    return x < 0 ? 0.5 * (1 + x) * (1 + x) : 1 - 0.5 * (1 - x) * (1 - x);
}

/// One axis from n texels to m. Each weight is the integral of the filter over the texel, so that any ratio n / m
/// treats all texels alike.
std::vector<Mixture> mixtures(int n, int m, core::Wrap wrap) {
    const double ratio = static_cast<double>(n) / m;
    std::vector<Mixture> row(static_cast<std::size_t>(m));
    if (n == m) {
        for (int i = 0; i < m; ++i) row[static_cast<std::size_t>(i)] = {{i}, {1.0f}};
        return row;
    }
    for (int i = 0; i < m; ++i) {
        const double center = (i + 0.5) * ratio;
        const int first = static_cast<int>(std::floor(center - ratio)),
                  last = static_cast<int>(std::ceil(center + ratio));
        Mixture& mixture = row[static_cast<std::size_t>(i)];
        for (int j = first; j < last; ++j) {
            const double weight = tent_integral((j + 1 - center) / ratio) - tent_integral((j - center) / ratio);
            if (weight <= 0) continue;
            mixture.from.push_back(wrapped(j, n, wrap));
            mixture.weight.push_back(static_cast<float>(weight));
        }
    }
    return row;
}

}  // namespace

int wrapped(int i, int n, core::Wrap wrap) {
    switch (wrap) {
        case core::Wrap::repeat:
            return ((i % n) + n) % n;
        case core::Wrap::mirrored_repeat: {
            const int j = ((i % (2 * n)) + 2 * n) % (2 * n);
            return j < n ? j : 2 * n - 1 - j;
        }
        case core::Wrap::clamp_to_edge:
            break;
    }
    return std::clamp(i, 0, n - 1);
}

core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v) {
    const int width = std::max(1, level.width() / 2), height = std::max(1, level.height() / 2);
    const std::vector<Mixture> columns = mixtures(level.width(), width, wrap_u);
    const std::vector<Mixture> rows = mixtures(level.height(), height, wrap_v);

    core::Plane<glm::vec4> narrow(width, level.height());
    for (int y = 0; y < level.height(); ++y) {
        const glm::vec4* const from = level.row(y);
        for (int x = 0; x < width; ++x) {
            const Mixture& mixture = columns[static_cast<std::size_t>(x)];
            glm::vec4 sum{0};
            for (std::size_t i = 0; i < mixture.from.size(); ++i) sum += mixture.weight[i] * from[mixture.from[i]];
            narrow.at(x, y) = sum;
        }
    }

    core::Plane<glm::vec4> half(width, height, glm::vec4{0});
    for (int y = 0; y < height; ++y) {
        const Mixture& mixture = rows[static_cast<std::size_t>(y)];
        for (std::size_t i = 0; i < mixture.from.size(); ++i) {
            const glm::vec4* const from = narrow.row(mixture.from[i]);
            glm::vec4* const to = half.row(y);
            for (int x = 0; x < width; ++x) to[x] += mixture.weight[i] * from[x];
        }
    }
    return half;
}

}  // namespace render2mpeg::image
