#pragma once

#include <cstdint>

#include "core/plane.h"

/// Quantisers by what the eye sees: a picture's own contrast hides errors.
namespace render2mpeg::encoder {

/// Factors of each macroblock's quantiser, (width + 15) / 16 by (height + 15) / 16: above 1 where contrast hides
/// errors, below 1 where luma is smooth. Their geometric mean is 1.
core::Plane<float> contrast_factors(const core::Plane<std::uint8_t>& luma);

}  // namespace render2mpeg::encoder
