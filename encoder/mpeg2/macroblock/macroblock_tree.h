#pragma once
// MB-tree: finer quantisers for macroblocks that later pictures are predicted from.
#include "core/motion_field.h"
#include "core/plane.h"

/// Quantiser factors of macroblocks by their use in later pictures: propagation as in MB-tree, from exact motion.
namespace render2mpeg::encoder::mpeg2 {

/// Factors of the quantiser of each macroblock of a reference, `columns` x `rows`. The picture as a whole has
/// (1 + n)^-propagation_strength already, where n pictures depend on it, at most most_followers; with its factor a
/// macroblock has (1 + s (k + k^2 + ... + k^n))^-inheritance_strength.
///
/// k is the share of its quality that each picture hands to the next. What stands still until the last of them, where
/// `onward` leads, is skipped and loses nothing; what is predicted between pixels loses detail; where pictures show
/// anew what the one before does not, to a mean square that quantisation does not hide, that is coded again:
/// `innovation` (encoder/innovation.h), null: 0 everywhere. s is the share of the macroblock that stays in the picture.
/// `quantiser`: quantiser_scale_code of the picture, or its equivalent.
///
/// Macroblocks may hang over the field's right and lower side.
core::Plane<float> quantiser_factors(const core::MotionField& onward, const core::Plane<float>* innovation, int columns,
                                     int rows, double quantiser);

}  // namespace render2mpeg::encoder::mpeg2
