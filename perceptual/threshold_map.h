#pragma once
// Thresholds of a picture: how far each coefficient may be off before the eye sees it.
#include <cstdint>

#include "core/dct.h"
#include "core/plane.h"

namespace render2mpeg::perceptual {

/// How far each DCT coefficient of a picture's luma may be off before the eye sees it.
struct ThresholdMap {
    std::int64_t picture = 0;  ///< display number
    /// One per 8x8 block of luma, (width + 7) / 8 by (height + 7) / 8 of them: thresholds of the orthonormal DCT's
    /// coefficients in code values, > 0 and finite, [v * 8 + u] with u the horizontal frequency.
    core::Plane<core::Block8x8> blocks;
};

}  // namespace render2mpeg::perceptual
