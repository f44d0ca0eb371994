#pragma once
// The 8x8 DCT of the visibility model, in float.
#include <array>

namespace render2mpeg::core {

/// An 8x8 block, row by row: samples [y * 8 + x], or coefficients [v * 8 + u] with u the horizontal frequency.
using Block8x8 = std::array<float, 64>;

/// Orthonormal DCT-II of the eye's model (docs/model/tolerance.md): coefficient 0 is 8 times the mean. The encoder has
/// an integer transform.
Block8x8 forward_dct(const Block8x8& samples);

/// Its inverse.
Block8x8 inverse_dct(const Block8x8& coefficients);

}  // namespace render2mpeg::core
