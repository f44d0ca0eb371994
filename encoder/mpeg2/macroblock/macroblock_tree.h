#pragma once
// MB-tree: finer quantisers for macroblocks that later pictures are predicted from.
#include "core/motion_field.h"
#include "core/plane.h"

namespace render2mpeg::encoder::mpeg2 {

/// How much finer or coarser than its picture each macroblock of a reference is worth coding, by what later pictures
/// take from it: factors of its quantiser, `columns` x `rows`. The picture as a whole has (1 + n)^-propagation_strength
/// already, n pictures depending on it, at most most_followers (rate_model.h). What stands still until the last of them
/// (`onward` leads there) is coded once and then skipped, so that its quality is that of all: in all (1 +
/// n)^-static_propagation_strength. All else is predicted between pixels, which loses detail each time; what leaves the
/// picture before the end counts for fewer: in all (1 + share n)^-propagation_strength. The macroblocks may hang over
/// the field's right and lower side.
core::Plane<float> quantiser_factors(const core::MotionField& onward, int columns, int rows);

}  // namespace render2mpeg::encoder::mpeg2
