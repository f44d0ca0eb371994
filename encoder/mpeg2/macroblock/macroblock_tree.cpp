#include "encoder/mpeg2/macroblock/macroblock_tree.h"

#include <algorithm>
#include <cmath>

#include "encoder/mpeg2/bitstream/tuning.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// chosen: an eighth of a pixel: less than what half-pel prediction tells apart, more than what a renderer's single
/// precision adds to zero.
constexpr float standstill = 0.125f;

/// Share of the macroblock's pixels, every fourth of every fourth row, that are still in the picture at the end.
double staying_share(const core::MotionField& onward, int column, int row) {
    constexpr int step = 4;
    const auto width = static_cast<float>(onward.vector.width()), height = static_cast<float>(onward.vector.height());
    int staying = 0, all = 0;
    for (int y = row * 16; y < std::min(row * 16 + 16, onward.vector.height()); y += step)
        for (int x = column * 16; x < std::min(column * 16 + 16, onward.vector.width()); x += step) {
            const glm::vec2 at = onward.vector.at(x, y) + glm::vec2(x, y);
            ++all;
            staying += onward.kind.at(x, y) != core::PixelClass::none && at.x >= 0 && at.y >= 0 && at.x <= width - 1 &&
                       at.y <= height - 1;
        }
    return static_cast<double>(staying) / std::max(1, all);
}

/// Whether every second pixel of every second row stands still. Macroblocks beyond the field, which are there where
/// pictures are fields, show nobody anything: they do not.
bool stands_still(const core::MotionField& onward, int column, int row) {
    constexpr int step = 2;
    const int end_x = std::min(column * 16 + 16, onward.vector.width());
    const int end_y = std::min(row * 16 + 16, onward.vector.height());
    if (row * 16 >= end_y || column * 16 >= end_x) return false;
    for (int y = row * 16; y < end_y; y += step)
        for (int x = column * 16; x < end_x; x += step) {
            const glm::vec2 v = onward.vector.at(x, y);
            const bool still = std::abs(v.x) <= standstill && std::abs(v.y) <= standstill;
            if (onward.kind.at(x, y) == core::PixelClass::none || !still) return false;
        }
    return true;
}

}  // namespace

core::Plane<float> quantiser_factors(const core::MotionField& onward, const core::Plane<float>* innovation, int columns,
                                     int rows, double quantiser) {
    EXPECTS(onward.reference > onward.picture);
    core::Plane<float> factors(columns, rows, 1.0f);
    const auto followers = static_cast<double>(onward.reference - onward.picture);
    const double picture = std::pow(1 + std::min(followers, static_cast<double>(most_followers)), propagation_strength);
    const double unseen = unseen_innovation * quantiser * quantiser;
    parallel::for_each(static_cast<std::size_t>(rows), [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int column = 0; column < columns; ++column) {
            const float fresh = innovation ? innovation->at(std::min(column, innovation->width() - 1),
                                                            std::min(row, innovation->height() - 1))
                                           : 0.0f;
            const double kept =
                unseen / (unseen + fresh) * (stands_still(onward, column, row) ? 1.0 : kept_by_interpolation);
            const double heirs = kept < 1 ? kept * (1 - std::pow(kept, followers)) / (1 - kept) : followers;
            factors.at(column, row) = static_cast<float>(
                picture * std::pow(1 + heirs * staying_share(onward, column, row), -inheritance_strength));
        }
    });
    return factors;
}

}  // namespace render2mpeg::encoder::mpeg2
