#pragma once
// The quantiser matrices and weights by which a film is tuned to the eye.
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/block_coding.h"
#include "encoder/types.h"

/// Quantiser matrices and distortion weights of each Tune.
namespace render2mpeg::encoder::mpeg2 {

/// The matrices that a film is coded with: the default ones for Tune::psnr.
Matrices matrices_for(Tune tune);

/// Weights of errors of luma, the same in every block; null: all 1. In P and B pictures that of a block's mean is
/// mean_weight times as much.
const Weights* weights_for(Tune tune, PictureType type);

}  // namespace render2mpeg::encoder::mpeg2
