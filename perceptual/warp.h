#pragma once
// Warps data of one picture to another along exact motion.
#include <algorithm>
#include <glm/glm.hpp>
#include <optional>

#include "core/motion_field.h"
#include "core/plane.h"
#include "core/visible.h"

/// Warps values from one picture to another along motion.
namespace render2mpeg::perceptual {

/// Value at pixels without the same surface point in the other picture.
inline constexpr float no_partner = -1.0f;

/// Fetches a value, or two, for every pixel of `here` from where its point was in the picture that saw `there`: the
/// mean of the four nearest pixels by bilinear weights, of those that show the same thing there [Render2MPEG, 4.3]: the
/// same kind, object and material, and the same triangle or at least a like depth and normal
/// (docs/model/tolerance.md). `no_partner` where none does or the place lies outside the picture. A null `motion` means
/// that nothing moves. No value is negative. T: float or glm::vec2.
template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const core::Visible& here,
                    const core::MotionField* motion);

/// Value of the point at (x, y) in the picture before, by bilinear lookup; none where the point has no place there, or
/// one outside the picture. `motion` leads there.
template <class T>
std::optional<float> value_along(const core::MotionField& motion, const core::Plane<T>& before, int x, int y) {
    if (motion.kind.at(x, y) == core::PixelClass::none) return std::nullopt;
    const glm::vec2 v = motion.vector.at(x, y);
    float px = motion.column(static_cast<float>(x) + v.x);
    const float py = static_cast<float>(y) + v.y;
    // Half a pixel beyond either edge of a panorama its other edge is as near.
    if (motion.wraps) px = std::clamp(px, 0.0f, static_cast<float>(before.width() - 1));
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
