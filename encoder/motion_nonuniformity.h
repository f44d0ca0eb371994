#pragma once

#include "core/motion_field.h"

/// Measures how unevenly a picture moves, which decides how many B pictures are worth it.
namespace render2mpeg::encoder {

/// How far from uniform the motion of a picture is: by how many pixels the motion of points a macroblock's width apart
/// differs, mean over the picture, per picture of the field's distance in time. Shifts have 0, slow walks 0.2, a camera
/// that races past walls over 1: one vector per macroblock serves the less, the further away a reference is. Steps of
/// more than half a macroblock are other surfaces' edges and do not count. 0 where nothing has motion.
double motion_nonuniformity(const core::MotionField& motion);

}  // namespace render2mpeg::encoder
