#pragma once
// Chooses the prediction modes that a macroblock tries in full.
#include "core/smallest.h"
#include "encoder/mpeg2/macroblock/macroblock.h"
#include "encoder/mpeg2/motion/motion_estimation.h"

/// Shortlists a B picture's prediction modes: forward, backward, or the mean of both.
namespace render2mpeg::encoder::mpeg2 {

/// The prediction modes of a B picture's macroblock that deserve to be tried in full.
struct ModeChoice {
    core::Smallest<PredictionMode, 4> modes;  ///< by Hadamard sum and bits
    int evaluations = 0;                      ///< 16x16 differences computed
};

/// Chooses among each direction's vectors alone and means of their best, and of those of the macroblock before.
/// `cost_per_bit` is in Hadamard sums.
ModeChoice choose_prediction_modes(const PictureCoding& picture, int column, int row, const SliceState& state,
                                   const BestVectors& forward, const BestVectors& backward, float cost_per_bit);

}  // namespace render2mpeg::encoder::mpeg2
