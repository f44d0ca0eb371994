#pragma once

// The loops behind kernels.h, included once per instruction set by a file that is compiled for it. Everything here has
// internal linkage, so that no function compiled for a newer processor can be linked into code that must run on an
// older one; for the same reason no other header with inline functions may be included.
//
// Vectors are the compiler's own (wider ones are split where the target lacks them): the same lanes and the same order
// of floating-point operations everywhere, hence the same numbers.

#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/kernels/kernels_levels.h"
#include "encoder/mpeg2/kernels/kernels_pixels.h"
#include "encoder/mpeg2/kernels/kernels_transforms.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

constexpr Kernels all_kernels = {
    satd_16x16,    activity_16x16, ssd_16x16,       ssd_8x8,        sad_16x16,
    predict_16x16, predict_8x8,    average,         forward_dct,    forward_dct_of_difference,
    quantise,      weigh,          inverse_dct_put, inverse_dct_add};

#undef R2M_INLINE

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
