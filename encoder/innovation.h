#pragma once

#include <cstdint>

#include "core/motion_field.h"
#include "core/plane.h"

/// Measures innovation over the picture before: noise, changing light, disocclusions.
namespace render2mpeg::encoder {

/// Mean squared difference, code values, of each macroblock's luma from the picture before along `motion`, in steps of
/// half pixels as in MPEG-2 prediction. (width + 15) / 16 by (height + 15) / 16. Pixels not seen there differ by 20.
/// Null: nothing moves.
core::Plane<float> innovation(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                              const core::Plane<std::uint8_t>& before);

}  // namespace render2mpeg::encoder
