#include "encoder/av/grain_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "core/film_grain.h"

namespace render2mpeg::av {
namespace {

constexpr int lag = 3, filter_shift = GrainTable::filter_shift;
/// Places in that reach, row by row.
constexpr std::size_t places = 2 * lag * (lag + 1);
using Weights = std::array<double, places>;

constexpr std::pair<int, int> place_of(std::size_t index) {
    const int at = static_cast<int>(index);
    return {at / (2 * lag + 1) - lag, at % (2 * lag + 1) - lag};
}

/// Luma of tables' points, 16..235.
constexpr std::array<int, 14> point_luma{16, 20, 28, 40, 56, 76, 98, 120, 142, 164, 186, 206, 224, 235};

/// Side of blocks that gradients are looked for in, pixels.
constexpr int block = 16;
/// Of the pictures, by which a range of luma is one of gradients. chosen: docs/measurements.md#codecs
constexpr double least_share = 0.005;

/// Weights that best predict grain of this spot (core::FilmGrain::spot) from its neighbours: the normal equations
/// (Yule-Walker), by elimination.
Weights predictor(double spot) {
    const auto correlation = [&](int down, int across) {
        return std::exp(-(down * down + across * across) / (4 * spot * spot));
    };
    // chosen: 0.1 of 0.02 to 0.3: the filter is stable and shows no lattice (0.02: correlations of 0.1 at six pixels);
    // correlations are up to 0.08 lower than those asked for.
    constexpr double white = 0.1;
    std::array<std::array<double, places + 1>, places> rows{};
    for (std::size_t i = 0; i < places; ++i) {
        const auto [down, across] = place_of(i);
        for (std::size_t k = 0; k < places; ++k)
            rows[i][k] = correlation(down - place_of(k).first, across - place_of(k).second) + (i == k ? white : 0.0);
        rows[i][places] = correlation(down, across);
    }
    // The matrix is positive definite: no row needs another's place.
    for (std::size_t i = 0; i < places; ++i)
        for (std::size_t k = 0; k < places; ++k) {
            if (k == i) continue;
            const double factor = rows[k][i] / rows[i][i];
            for (std::size_t j = i; j <= places; ++j) rows[k][j] -= factor * rows[i][j];
        }
    Weights weights{};
    for (std::size_t i = 0; i < places; ++i) weights[i] = rows[i][places] / rows[i][i];
    return weights;
}

/// How much the filter multiplies the variance of white noise by: the sum of its squared impulse response.
double gain_of(const std::array<int, places>& filter) {
    constexpr int reach = 32;
    core::Plane<double> response(2 * reach + 1, reach, 0.0);
    double sum = 0;
    for (int y = lag; y < reach; ++y)
        for (int x = lag; x < response.width() - lag; ++x) {
            double value = y == lag && x == reach ? 1 : 0;
            for (std::size_t i = 0; i < places; ++i)
                value += filter[i] * response.at(x + place_of(i).second, y + place_of(i).first) / (1 << filter_shift);
            response.at(x, y) = value;
            sum += value * value;
        }
    return sum;
}

/// Whether a block is smooth, with steps: no two neighbours differ by more than one, and few differ.
bool has_steps(const core::Plane<std::uint8_t>& luma, int left, int top) {
    int changes = 0;
    for (int y = top; y < top + block; ++y) {
        const std::uint8_t *row = luma.row(y), *above = luma.row(std::max(y - 1, top));
        for (int x = left; x < left + block; ++x) {
            const int across = std::abs(row[x] - row[std::max(x - 1, left)]), down = std::abs(row[x] - above[x]);
            if (across > 1 || down > 1) return false;
            changes += across + down;
        }
    }
    constexpr int most = 2 * block * block / 4;
    return changes > 0 && changes <= most;
}

bool is_flat(const core::Plane<std::uint8_t>& luma, int left, int top) {
    for (int y = top; y < top + block; ++y)
        for (int x = left; x < left + block; ++x)
            if (luma.at(x, y) != luma.at(left, top)) return false;
    return true;
}

}  // namespace

GrainTable film_grain_table(int iso, int height) {
    const core::FilmGrain grain(iso, height);
    GrainTable table;
    table.lag = lag;
    const Weights weights = predictor(grain.spot());
    for (std::size_t i = 0; i < places; ++i)
        table.filter[i] = std::clamp(static_cast<int>(std::lround(weights[i] * (1 << filter_shift))), -128, 127);
    // What is filtered is cut off at 127.
    constexpr double most = 36;
    double deviation = GrainTable::unfiltered * std::sqrt(gain_of(table.filter));
    for (; deviation > most && table.noise_shift < 3; deviation /= 2) ++table.noise_shift;

    const auto factor = [&](int luma) {
        return std::lround(grain.deviation(static_cast<float>(luma)) / deviation * (1 << table.scaling_shift));
    };
    const auto is_too_large = [&](int luma) { return factor(luma) > 255; };
    table.scaling_shift = 11;
    while (table.scaling_shift > 8 && std::ranges::any_of(point_luma, is_too_large)) --table.scaling_shift;
    for (const int luma : point_luma) table.points.push_back({luma, static_cast<int>(std::min(factor(luma), 255L))});
    return table;
}

void GradientDither::add(const core::Plane<std::uint8_t>& luma) {
    for (int top = 0; top + block <= luma.height(); top += block)
        for (int left = 0; left + block <= luma.width(); left += block) {
            pixels_ += block * block;
            if (is_flat(luma, left, top)) continue;
            std::array<std::int64_t, 256>& counts = has_steps(luma, left, top) ? steps_ : others_;
            for (int y = top; y < top + block; ++y)
                for (int x = left; x < left + block; ++x) ++counts[luma.at(x, y)];
        }
}

GrainTable GradientDither::table() const {
    std::array<bool, point_luma.size()> on{};
    for (std::size_t i = 0; i + 1 < on.size(); ++i) {
        const auto sum = [&](const std::array<std::int64_t, 256>& counts) {
            return std::accumulate(counts.begin() + point_luma[i], counts.begin() + point_luma[i + 1], std::int64_t{0});
        };
        const std::int64_t steps = sum(steps_);
        if (static_cast<double>(steps) > least_share * static_cast<double>(pixels_) && steps > sum(others_))
            on[i] = on[i + 1] = true;
    }
    GrainTable table;
    table.noise_shift = 1;
    // The deviation of rounding is that of a uniform number: 1 / sqrt(12).
    const double deviation = GrainTable::unfiltered / (1 << table.noise_shift);
    const auto scaling = static_cast<int>(std::lround((1 << table.scaling_shift) / (deviation * std::sqrt(12.0))));
    for (std::size_t i = 0; i < on.size(); ++i) {
        // Within a run the points at its ends say all.
        const bool differs = (i > 0 && on[i] != on[i - 1]) || (i + 1 < on.size() && on[i] != on[i + 1]);
        const bool is_end = on[i] && (i == 0 || i + 1 == on.size());
        if (differs || is_end) table.points.push_back({point_luma[i], on[i] ? scaling : 0});
    }
    return table;
}

}  // namespace render2mpeg::av
