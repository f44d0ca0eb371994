#pragma once
// Quantisers of picture types in libavcodec's encoders.
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Quantisers of I and of B pictures less those of P pictures that nothing refers to.
struct LibraryOffsets {
    int intra, bidirectional;
};

/// chosen: docs/measurements.md#codecs. SVT-AV1 has its own by layers, which it does not tell.
constexpr LibraryOffsets library_offsets(Codec codec) {
    return codec == Codec::av1 ? LibraryOffsets{0, 0} : LibraryOffsets{-3, 2};
}

}  // namespace render2mpeg::encoder
