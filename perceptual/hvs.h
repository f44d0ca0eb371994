#pragma once
// PSNR-HVS-M: mean squared error as the eye sees it.
#include <cstdint>

#include "core/plane.h"

/// The metric PSNR-HVS-M.
namespace render2mpeg::perceptual {

/// Mean squared error of two planes of the same size as the eye sees it: differences of DCT coefficients are weighted
/// by contrast sensitivity, after what the block's own contrast hides was taken off (docs/model/metrics.md). In
/// code values squared, to be averaged over a film and then given to psnr(). 0 for equal planes, and where the eye sees
/// no difference. Like the original it looks at whole 8x8 blocks only; a plane too small for one is filled up to one by
/// repeating its edges. Symmetric.
double masked_error(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b);

}  // namespace render2mpeg::perceptual
