#include "perceptual/pumping.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "perceptual/warp.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int block_size = 16;

/// chosen: 8 code values: what a lamp does to its room within a picture is less, what comes out from behind an edge
/// mostly more.
constexpr double something_else = 8;

/// How much the mean of a block changes; none where less than half of it was there before.
template <class T>
std::optional<double> change_of_block(const core::MotionField* motion, const core::Plane<T>& now,
                                      const core::Plane<T>& before, int left, int top) {
    const int right = std::min(left + block_size, now.width()), bottom = std::min(top + block_size, now.height());
    double sum = 0;
    int count = 0;
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
            const std::optional<float> there =
                motion ? value_along(*motion, before, x, y) : std::optional(static_cast<float>(before.at(x, y)));
            if (!there) continue;
            sum += static_cast<double>(now.at(x, y)) - static_cast<double>(*there);
            ++count;
        }
    if (2 * count < (right - left) * (bottom - top)) return std::nullopt;
    return sum / count;
}

/// Gives `take` the change of every block that counts.
template <class T, class Take>
void each_change(const core::MotionField* motion, const core::Plane<T>& now, const core::Plane<T>& before,
                 const Take& take) {
    EXPECTS(now.width() == before.width() && now.height() == before.height());
    EXPECTS(!motion || (motion->kind.width() == now.width() && motion->kind.height() == now.height()));
    for (int top = 0; top < now.height(); top += block_size)
        for (int left = 0; left < now.width(); left += block_size)
            if (const std::optional<double> change = change_of_block(motion, now, before, left, top)) take(*change);
}

}  // namespace

core::Plane<std::int16_t> luma_error(const core::Plane<std::uint8_t>& decoded,
                                     const core::Plane<std::uint8_t>& source) {
    EXPECTS(decoded.width() == source.width() && decoded.height() == source.height());
    core::Plane<std::int16_t> error(decoded.width(), decoded.height());
    for (int y = 0; y < decoded.height(); ++y)
        for (int x = 0; x < decoded.width(); ++x)
            error.at(x, y) = static_cast<std::int16_t>(decoded.at(x, y) - source.at(x, y));
    return error;
}

std::optional<double> pumping(const core::MotionField* motion, const core::Plane<std::int16_t>& now,
                              const core::Plane<std::int16_t>& before) {
    double squares = 0;
    int blocks = 0;
    each_change(motion, now, before, [&](double change) {
        squares += change * change;
        ++blocks;
    });
    if (blocks == 0) return std::nullopt;
    return std::sqrt(squares / blocks);
}

std::optional<double> light_change(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                                   const core::Plane<std::uint8_t>& before) {
    double sum = 0;
    int blocks = 0;
    each_change(motion, now, before, [&](double change) {
        if (std::abs(change) > something_else) return;
        sum += std::abs(change);
        ++blocks;
    });
    if (blocks == 0) return std::nullopt;
    return sum / blocks;
}

double change_along(const core::MotionField& motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before) {
    EXPECTS(now.width() == before.width() && now.height() == before.height());
    EXPECTS(motion.kind.width() == now.width() && motion.kind.height() == now.height());
    double sum = 0, count = 0;
    for (int y = 0; y < now.height(); ++y)
        for (int x = 0; x < now.width(); ++x) {
            const std::optional<float> there = value_along(motion, before, x, y);
            if (!there) continue;
            sum += std::abs(static_cast<double>(now.at(x, y)) - static_cast<double>(*there));
            count += 1;
        }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace render2mpeg::perceptual
