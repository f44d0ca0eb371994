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

/// chosen: 8 code values per picture: a lamp that comes on in a third of a second changes its room by less.
constexpr float another_scene = 8;

/// Share of the macroblock's pixels, every fourth of every fourth row, that are still in the picture at the end.
float staying_share(const core::MotionField& onward, int column, int row) {
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
    return static_cast<float>(staying) / static_cast<float>(std::max(1, all));
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

core::Plane<float> quantiser_factors(const core::MotionField& onward, int columns, int rows,
                                     const core::Plane<float>* light_change) {
    EXPECTS(onward.reference > onward.picture);
    core::Plane<float> factors(columns, rows, 1.0f);
    const std::int64_t all = onward.reference - onward.picture;
    const auto following = static_cast<float>(std::min(all, most_followers));
    constexpr auto propagation = static_cast<float>(propagation_strength);
    const auto finer_by = [&](float strength) {
        return std::pow(1.0f + following, propagation) * std::pow(1.0f + static_cast<float>(all), -strength);
    };
    const float finer = finer_by(static_propagation_strength), finer_in_light = finer_by(lit_propagation_strength);
    parallel::for_each(static_cast<std::size_t>(rows), [&](std::size_t row) {
        for (int column = 0; column < columns; ++column)
            if (stands_still(onward, column, static_cast<int>(row))) {
                const float change = light_change ? light_change->at(column, static_cast<int>(row)) : 0.0f;
                const bool lit = change > static_cast<float>(steady_light) && change < another_scene;
                factors.at(column, static_cast<int>(row)) = lit ? finer_in_light : finer;
            } else {
                const float staying = following * staying_share(onward, column, static_cast<int>(row));
                factors.at(column, static_cast<int>(row)) =
                    std::pow((1.0f + following) / (1.0f + staying), propagation);
            }
    });
    return factors;
}

core::Plane<float> macroblock_means(const Frame& picture) {
    core::Plane<float> means(picture.columns(), picture.rows());
    for (int row = 0; row < picture.rows(); ++row)
        for (int column = 0; column < picture.columns(); ++column) {
            int sum = 0;
            for (int y = 0; y < 16; ++y) {
                const std::uint8_t* samples = picture.y.row(16 * row + y) + 16 * column;
                for (int x = 0; x < 16; ++x) sum += samples[x];
            }
            means.at(column, row) = static_cast<float>(sum) / 256;
        }
    return means;
}

}  // namespace render2mpeg::encoder::mpeg2
