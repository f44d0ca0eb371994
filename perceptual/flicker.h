#pragma once
// Measures flicker: change of luma along motion.
#include <cstdint>

#include "core/motion_field.h"
#include "core/plane.h"

/// Measures a film's flicker.
namespace render2mpeg::perceptual {

/// Mean absolute change of luma along motion from the picture before, in code values: what flickers, and what changes
/// in truth. `motion` leads from `now` to `before`; what has no place there, or one outside the picture, does not
/// count. 0 where nothing counts. A film's flicker is what it changes more than its reference does.
double change_along(const core::MotionField& motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before);

}  // namespace render2mpeg::perceptual
