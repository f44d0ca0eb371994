#pragma once
// The cheapest pictures there are, for buffers that leave room for nothing else.
#include <cstdint>

#include "encoder/mpeg2/picture/picture_coding.h"

/// The cheapest pictures there are: what is coded where a buffer leaves room for nothing else, and what may be promised
/// of every picture that is still to come.
namespace render2mpeg::encoder::mpeg2 {

/// An intra picture of one colour, the source's mean; a predicted one that repeats its earlier reference.
PictureResult minimal_picture(const PictureTask& task);

/// Bits of whole access units, whatever they show.
struct MinimalBits {
    std::int64_t intra = 0;  ///< with sequence and GOP headers
    std::int64_t other = 0;
};
MinimalBits minimal_bits(const Settings& settings, const Level& level);

}  // namespace render2mpeg::encoder::mpeg2
