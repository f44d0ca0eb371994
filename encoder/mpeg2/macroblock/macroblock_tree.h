#pragma once
// MB-tree: finer quantisers for macroblocks that later pictures are predicted from.
#include "core/motion_field.h"
#include "core/plane.h"
#include "encoder/mpeg2/kernels/frame.h"

/// Quantiser factors of macroblocks by what later pictures take from them: propagation as in MB-tree, from exact
/// motion.
namespace render2mpeg::encoder::mpeg2 {

/// Factors of the quantiser of each macroblock of a reference, `columns` x `rows`. The picture as a whole has
/// (1 + n)^-propagation_strength already, where n pictures depend on it, at most most_followers.
///
/// What stands still until the last of them, where `onward` leads, is coded once and then skipped, so that its quality
/// is that of all: with its factor it has (1 + n)^-static_propagation_strength.
///
/// All else is predicted between pixels and loses detail each time; what leaves the picture counts for fewer: with its
/// factor it has (1 + s n)^-propagation_strength, s being the share of it that stays.
///
/// Where its light changes by more than steady_light, but not to another scene, the exponent of what stands still is
/// lit_propagation_strength: `light_change`, code values per picture and macroblock; null: nowhere.
///
/// Macroblocks may hang over the field's right and lower side.
core::Plane<float> quantiser_factors(const core::MotionField& onward, int columns, int rows,
                                     const core::Plane<float>* light_change = nullptr);

/// Mean luma of each macroblock, code values.
core::Plane<float> macroblock_means(const Frame& picture);

}  // namespace render2mpeg::encoder::mpeg2
