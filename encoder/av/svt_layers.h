#pragma once
#include <array>
#include <cstdint>

namespace render2mpeg::av {

/// Step of a picture's coefficients over that of the film's quantiser, > 0, at most 1. Pictures behind a key picture
/// are taken together in groups of 16, of what is left in 8, 4 and at last up to three; the last of a group comes
/// first, then its middle, then the middles of the halves, each layer coarser than the one before. `place` of the
/// picture and of the `last` of its GOP, from 0, the key picture. Blocks that others are predicted from are finer than
/// that.
float svt_step_ratio(std::int64_t place, std::int64_t last);

/// Values of AV1's base_q_idx, of 8 bits, from one of SVT-AV1's quantisers to the next, and steps of films' quantisers.
inline constexpr double indices_of_quantiser = 4, steps_of_quantiser = 16;

/// The whole quantiser that SVT-AV1 is told for one: the nearest, or one finer where it takes no offset as large.
int svt_quantiser(double quantiser);
/// What base_q_idx is beyond that quantiser's in key pictures, and by layer from the last of a group on.
using IndexOffsets = std::array<int, 7>;
/// That of a quantiser, which may lie between two whole ones: layers are rounded each for itself, so that quantisers
/// have more steps than an index.
IndexOffsets svt_index_offsets(double quantiser);

}  // namespace render2mpeg::av
