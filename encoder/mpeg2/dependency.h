#pragma once

#include "core/motion_field.h"
#include "core/plane.h"

namespace render2mpeg::encoder::mpeg2 {

/// How much finer than the rest of a picture each macroblock of a reference is worth coding, by what later pictures
/// take from it: factors of its quantiser, `columns` x `rows`. What stands still until the last picture that depends on
/// this one (`onward` leads there) is coded once and then skipped, so that its quality is that of 1 + n pictures:
/// (1 + n)^-dependency_strength. All else is predicted between pixels, which loses detail each time: 1. The macroblocks
/// may hang over the field's right and lower side.
core::Plane<float> quantiser_factors(const core::MotionField& onward, int columns, int rows);

}  // namespace render2mpeg::encoder::mpeg2
