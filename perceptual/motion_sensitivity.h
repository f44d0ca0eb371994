#pragma once
// How much less detail the eye sees in what moves.
#include "core/motion_field.h"

/// The eye's sensitivity to detail that moves.
namespace render2mpeg::perceptual {

/// The eye's sensitivity to detail that moves as these pixels do, relative to what stands still: mean over the picture,
/// 0..1. `field` leads to the picture before or after, `hertz` is the pictures' rate; pixels without motion count as
/// still. The eye follows what moves, but not quite. [Daly1998]
double motion_sensitivity(const core::MotionField& field, double hertz);

}  // namespace render2mpeg::perceptual
