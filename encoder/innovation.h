#pragma once

#include <cstdint>

#include "core/motion_field.h"
#include "core/plane.h"

/// Measures what pictures show that the picture before does not: noise, light that changes, what was hidden.
namespace render2mpeg::encoder {

/// Mean squared difference, code values, of each macroblock's luma from what the picture before shows where `motion`
/// leads, in steps of half pixels as MPEG-2 predicts. (width + 15) / 16 by (height + 15) / 16. What is not seen there
/// differs by 20. Null: nothing moves.
core::Plane<float> innovation(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                              const core::Plane<std::uint8_t>& before);

}  // namespace render2mpeg::encoder
