#include "encoder/innovation.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder {
namespace {

/// chosen: every second pixel of every second row: a quarter of the time for the same quantisers.
constexpr int innovation_step = 2;

/// chosen: squares of differences beyond 20 code values count as if they were of 20: another surface.
constexpr float other_surface = 400;

/// The squared difference at a pixel.
float difference_at(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before, int x, int y) {
    int x2 = 2 * x, y2 = 2 * y;  // half pixels
    if (motion) {
        const glm::vec2 v = motion->vector.at(x, y) * 2.0f;
        constexpr float far = 8192;
        if (motion->kind.at(x, y) == core::PixelClass::none || !(std::abs(v.x) < far && std::abs(v.y) < far))
            return other_surface;
        x2 += static_cast<int>(std::lround(v.x));
        y2 += static_cast<int>(std::lround(v.y));
    }
    if (x2 < 0 || y2 < 0 || x2 > 2 * (now.width() - 1) || y2 > 2 * (now.height() - 1)) return other_surface;
    const std::uint8_t* upper = before.row(y2 >> 1) + (x2 >> 1);
    const std::uint8_t* lower = before.row((y2 + 1) >> 1) + (x2 >> 1);
    const int right = x2 & 1;
    const float there = 0.25f * static_cast<float>(upper[0] + upper[right] + lower[0] + lower[right]);
    const float difference = static_cast<float>(now.at(x, y)) - there;
    return std::min(difference * difference, other_surface);
}

}  // namespace

core::Plane<float> innovation(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                              const core::Plane<std::uint8_t>& before) {
    EXPECTS(now.width() == before.width() && now.height() == before.height());
    EXPECTS(!motion || (motion->vector.width() == now.width() && motion->vector.height() == now.height()));
    core::Plane<float> means((now.width() + 15) / 16, (now.height() + 15) / 16);
    parallel::for_each(static_cast<std::size_t>(means.height()), [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int column = 0; column < means.width(); ++column) {
            float sum = 0;
            int count = 0;
            for (int y = 16 * row; y < std::min(16 * row + 16, now.height()); y += innovation_step)
                for (int x = 16 * column; x < std::min(16 * column + 16, now.width()); x += innovation_step, ++count)
                    sum += difference_at(motion, now, before, x, y);
            means.at(column, row) = sum / static_cast<float>(count);
        }
    });
    return means;
}

}  // namespace render2mpeg::encoder
