#pragma once
#include <cstdint>

#include "core/dct.h"
#include "core/picture.h"
#include "core/plane.h"

namespace render2mpeg::perceptual {

/// How far each DCT coefficient of a picture's luma may be off before the eye sees it.
struct ThresholdMap {
    std::int64_t picture = 0;  ///< display number
    /// One per 8x8 block of luma: thresholds of the orthonormal DCT's coefficients in code values, > 0 and finite, [v *
    /// 8 + u] with u the horizontal frequency.
    core::Plane<core::Block8x8> blocks;
};

template <class A>
void archive(A& a, ThresholdMap& map) {
    auto& [picture, blocks] = map;
    a(picture, blocks);
}

/// Thresholds by luminance and contrast masking (docs/model/tolerance.md) from unrounded luma, or `y` without it; edges
/// repeat beyond the picture. The luma is finite.
ThresholdMap mask(const core::Picture& picture);

/// Both steps of mask(): the DCT of every block, and thresholds from it, to the last bit.
core::Plane<core::Block8x8> transform(const core::Picture& picture);
ThresholdMap mask(const core::Plane<core::Block8x8>& coefficients, std::int64_t number);

/// Octaves by which each macroblock's own contrast raises the thresholds of a flat one of the mean luminance
/// [Render2MPEG, eq. 7.2]: mean over the AC coefficients of its blocks, so that an edge hides less than noise. 0 where
/// luma is flat. (width + 15) / 16 by (height + 15) / 16.
core::Plane<float> hidden(const core::Picture& picture);

/// Thresholds of a picture of one colour: the eye's sensitivity.
const core::Block8x8& masking_sensitivity();

}  // namespace render2mpeg::perceptual
