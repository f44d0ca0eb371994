#pragma once
// Quantisers of picture types in libavcodec's encoders.
#include <cstdint>

#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Quantisers of I and of B pictures less those of P pictures that nothing refers to. `middle`: of the B picture that
/// the others of its run refer to; it is the one in the middle of two or more.
struct LibraryOffsets {
    int intra, bidirectional, middle;
};

/// Whether B picture `index`, from 0, of a run of `length` is the one in the middle.
constexpr bool is_middle(std::int64_t index, std::int64_t length) {
    return length > 1 && index == length / 2;
}

/// chosen: docs/measurements.md#codecs. SVT-AV1 has its own by layers, which it does not tell.
constexpr LibraryOffsets library_offsets(Codec codec) {
    return codec == Codec::av1 ? LibraryOffsets{0, 0, 0} : LibraryOffsets{-3, 2, 1};
}

}  // namespace render2mpeg::encoder
