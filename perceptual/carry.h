#pragma once

#include "core/motion_field.h"
#include "core/plane.h"
#include "core/visible.h"

namespace render2mpeg::perceptual {

/// What pixels of another picture have stands for `no_partner` where nobody there is the same surface point.
inline constexpr float no_partner = -1.0f;

/// Fetches a value for every pixel of `here` from where its point was in the picture that saw `there`: the mean of the
/// four nearest pixels by bilinear weights, of those that show the same thing there [Render2MPEG, 4.3]: the same kind,
/// object and material, and the same triangle or at least a like depth and normal (docs/model.md, "Carrying").
/// `no_partner` where none does or the place lies outside the picture. A null `motion` means that nothing moves. Values
/// >= 0.
core::Plane<float> carry(const core::Plane<float>& values, const core::Visible& there, const core::Visible& here,
                         const core::MotionField* motion);

}  // namespace render2mpeg::perceptual
