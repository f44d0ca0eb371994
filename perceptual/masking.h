#pragma once
#include <cstdint>

#include "core/dct.h"
#include "core/picture.h"
#include "core/plane.h"

/// Thresholds of DCT coefficients by luminance and contrast masking [Render2MPEG, eq. 7.1 and 7.2].
namespace render2mpeg::perceptual {

/// How far each DCT coefficient of a picture's luma may be off before the eye sees it.
struct ThresholdMap {
    std::int64_t picture = 0;  ///< display number
    /// One per 8x8 block of luma, (width + 7) / 8 by (height + 7) / 8 of them: thresholds of the orthonormal DCT's
    /// coefficients in code values, > 0 and finite, [v * 8 + u] with u the horizontal frequency.
    core::Plane<core::Block8x8> blocks;
};

/// The thresholds of a picture by luminance and contrast masking (docs/model/tolerance.md), from its unrounded luma,
/// or from `y` where it has none. Blocks that hang over the right or lower side are filled up by repeating the edge.
/// The luma is finite. A picture without pixels has no blocks.
ThresholdMap mask(const core::Picture& picture);

/// The two halves of it, for who needs the coefficients as well: the DCT of every block, and thresholds from it. mask()
/// is their composition, to the last bit.
core::Plane<core::Block8x8> transform(const core::Picture& picture);
ThresholdMap mask(const core::Plane<core::Block8x8>& coefficients, std::int64_t number);

/// What stands for the eye's sensitivity to each coefficient: a picture of one colour has these thresholds.
const core::Block8x8& masking_sensitivity();

}  // namespace render2mpeg::perceptual
