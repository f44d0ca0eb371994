#include "image/halve.h"

#include <algorithm>
#include <array>
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
/// and Kaiser windows (docs/measurements.md#pictures).
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

core::Plane<glm::vec4> halve(int width, int height, const RowOf& row, core::Wrap wrap_u, core::Wrap wrap_v) {
    const int half_width = std::max(1, width / 2), half_height = std::max(1, height / 2);
    const std::vector<Mixture> columns = mixtures(width, half_width, wrap_u);
    const std::vector<Mixture> rows = mixtures(height, half_height, wrap_v);

    // Rows of half the width, each kept while it is wanted: a row of the result is made of six neighbours at most, of
    // which those at an edge may come from the other.
    constexpr int kept = 8;
    std::array<std::vector<glm::vec4>, kept> narrow;
    std::array<int, kept> number;
    number.fill(-1);
    const auto narrow_row = [&](int y) -> const std::vector<glm::vec4>& {
        const auto place = static_cast<std::size_t>(y % kept);
        if (number[place] == y) return narrow[place];
        number[place] = y;
        narrow[place].resize(static_cast<std::size_t>(half_width));
        const glm::vec4* const from = row(y);
        std::transform(columns.begin(), columns.end(), narrow[place].begin(), [&](const Mixture& mixture) {
            glm::vec4 sum{0};
            for (std::size_t i = 0; i < mixture.from.size(); ++i) sum += mixture.weight[i] * from[mixture.from[i]];
            return sum;
        });
        return narrow[place];
    };

    core::Plane<glm::vec4> half(half_width, half_height, glm::vec4{0});
    for (int y = 0; y < half_height; ++y) {
        const Mixture& mixture = rows[static_cast<std::size_t>(y)];
        for (std::size_t i = 0; i < mixture.from.size(); ++i) {
            const std::vector<glm::vec4>& from = narrow_row(mixture.from[i]);
            glm::vec4* const to = half.row(y);
            for (std::size_t x = 0; x < from.size(); ++x) to[x] += mixture.weight[i] * from[x];
        }
    }
    return half;
}

core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v) {
    return halve(
        level.width(), level.height(), [&](int y) { return level.row(y); }, wrap_u, wrap_v);
}

}  // namespace render2mpeg::image
