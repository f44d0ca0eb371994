#pragma once
// Looks up one picture's values along motion from another.
#include <algorithm>
#include <optional>

#include "core/motion_field.h"
#include "core/plane.h"

namespace render2mpeg::perceptual {

/// What the point at (x, y) had in the picture before, by bilinear lookup; none where it has no place there, or one
/// outside the picture. `motion` leads there.
template <class T>
std::optional<float> value_along(const core::MotionField& motion, const core::Plane<T>& before, int x, int y) {
    if (motion.kind.at(x, y) == core::PixelClass::none) return std::nullopt;
    const glm::vec2 v = motion.vector.at(x, y);
    const float px = static_cast<float>(x) + v.x, py = static_cast<float>(y) + v.y;
    if (!(px >= 0 && py >= 0)) return std::nullopt;
    if (!(px <= static_cast<float>(before.width() - 1) && py <= static_cast<float>(before.height() - 1)))
        return std::nullopt;
    const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
    const int x1 = std::min(x0 + 1, before.width() - 1), y1 = std::min(y0 + 1, before.height() - 1);
    const float s = px - static_cast<float>(x0), t = py - static_cast<float>(y0);
    return (1 - t) * ((1 - s) * static_cast<float>(before.at(x0, y0)) + s * static_cast<float>(before.at(x1, y0))) +
           t * ((1 - s) * static_cast<float>(before.at(x0, y1)) + s * static_cast<float>(before.at(x1, y1)));
}

}  // namespace render2mpeg::perceptual
