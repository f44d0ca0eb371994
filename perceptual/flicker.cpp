#include "perceptual/flicker.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::perceptual {

double change_along(const core::MotionField& motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before) {
    EXPECTS(now.width() == before.width() && now.height() == before.height());
    EXPECTS(motion.kind.width() == now.width() && motion.kind.height() == now.height());
    double sum = 0, count = 0;
    for (int y = 0; y < now.height(); ++y)
        for (int x = 0; x < now.width(); ++x) {
            if (motion.kind.at(x, y) == core::PixelClass::none) continue;
            const glm::vec2 v = motion.vector.at(x, y);
            const float px = static_cast<float>(x) + v.x, py = static_cast<float>(y) + v.y;
            if (!(px >= 0 && py >= 0)) continue;
            if (!(px <= static_cast<float>(now.width() - 1) && py <= static_cast<float>(now.height() - 1))) continue;
            const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
            const int x1 = std::min(x0 + 1, now.width() - 1), y1 = std::min(y0 + 1, now.height() - 1);
            const float s = px - static_cast<float>(x0), t = py - static_cast<float>(y0);
            const float there = (1 - t) * ((1 - s) * before.at(x0, y0) + s * before.at(x1, y0)) +
                                t * ((1 - s) * before.at(x0, y1) + s * before.at(x1, y1));
            sum += std::abs(static_cast<double>(now.at(x, y)) - static_cast<double>(there));
            count += 1;
        }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace render2mpeg::perceptual
