#pragma once
#include <cstdint>

#include "encoder/types.h"

namespace render2mpeg::av {

/// Step of a picture's coefficients in SVT-AV1's fixed quantiser over that of the quantiser, > 0, at most 1. Pictures
/// behind a key picture are taken together in groups of 16, of what is left in 8, 4 and at last up to three; the last
/// of a group comes first, then its middle, then the middles of the halves, each layer coarser than the one before.
/// `place` of the picture and of the `last` of its GOP, from 0, the key picture. From headers of SVT-AV1 1.4 at
/// quantisers 20 to 45, to a tenth; the same for any pictures.
float svt_step_ratio(std::int64_t place, std::int64_t last, encoder::Effort effort);

}  // namespace render2mpeg::av
