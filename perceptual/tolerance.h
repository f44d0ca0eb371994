#pragma once
// Tolerances of pixels from the errors of their blocks, in space and time: eqs. 7.4 and 7.5.
#include <functional>

#include "core/dct.h"
#include "core/plane.h"
#include "perceptual/distortion.h"
#include "perceptual/inverse_luma.h"

namespace render2mpeg::perceptual {

/// Blocks' errors: coefficient by coefficient, with signs, for block (column, row).
using BlockErrors = std::function<core::Block8x8(int column, int row)>;

/// RMS of the blocks' errors, interpolated between blocks, > 0, code values (docs/decisions.md#told-by-blocks).
core::Plane<float> distances(int width, int height, const BlockErrors& errors);

/// The share of its luminance that a pixel may be off where nothing else is known. [Render2MPEG, 4.2]
inline constexpr float least_relative = 0.02f;

/// Luma distances to luminance tolerances in place: e = max(0.02 Y, |Y^ - Y|) [Render2MPEG, eq. 7.4], with at least
/// half a code value.
void to_tolerances(core::Plane<float>& distances, const PixelLight& light, const InverseLuma& display);

/// dY(t) = (1 - w) e + w dY(t - 1) [Render2MPEG, eq. 7.5] in place of e; w = 0.5 where the warped `before` is > 0, else
/// 0. An empty `before` changes nothing.
void blend(core::Plane<float>& errors, const core::Plane<float>& before);

}  // namespace render2mpeg::perceptual
