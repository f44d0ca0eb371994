#include "encoder/contrast_masking.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder {
namespace {

/// Quantisers grow with this power of the variance. chosen: docs/measurements.md#codecs
constexpr double masking_strength = 0.15;

/// Variance, squared code values, below which contrast hides nothing. chosen: docs/measurements.md#codecs
constexpr double unseen_variance = 12;

constexpr int block_side = 8;

/// Variance of the block that begins at (x, y), as far as it lies in the picture.
double variance_at(const core::Plane<std::uint8_t>& luma, int x, int y) {
    const int right = std::min(x + block_side, luma.width()), below = std::min(y + block_side, luma.height());
    int sum = 0, squares = 0;
    for (int j = y; j < below; ++j)
        for (int i = x; i < right; ++i) {
            const int value = luma.at(i, j);
            sum += value;
            squares += value * value;
        }
    const double count = (right - x) * (below - y), mean = sum / count;
    return std::max(0.0, squares / count - mean * mean);
}

/// Mean logarithm, base 2, of the variances of a macroblock's blocks: smooth parts count as much as edges.
double contrast_at(const core::Plane<std::uint8_t>& luma, int column, int row) {
    double sum = 0;
    int blocks = 0;
    for (int y = 16 * row; y < std::min(16 * row + 16, luma.height()); y += block_side)
        for (int x = 16 * column; x < std::min(16 * column + 16, luma.width()); x += block_side, ++blocks)
            sum += std::log2(variance_at(luma, x, y) + unseen_variance);
    return sum / blocks;
}

}  // namespace

core::Plane<float> contrast_factors(const core::Plane<std::uint8_t>& luma) {
    EXPECTS(!luma.empty());
    core::Plane<float> factors((luma.width() + 15) / 16, (luma.height() + 15) / 16);
    parallel::for_each(static_cast<std::size_t>(factors.height()), [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int column = 0; column < factors.width(); ++column)
            factors.at(column, row) = static_cast<float>(contrast_at(luma, column, row));
    });
    double sum = 0;
    for (const float contrast : factors.values()) sum += static_cast<double>(contrast);
    const double mean = sum / static_cast<double>(factors.size());
    for (float& factor : factors.values())
        factor = static_cast<float>(std::exp2(masking_strength * (static_cast<double>(factor) - mean)));
    return factors;
}

}  // namespace render2mpeg::encoder
