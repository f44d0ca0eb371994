#pragma once
// The units of a coded picture: headers of the stream apart from data of the picture.
#include <cstdint>
#include <span>
#include <vector>

#include "encoder/types.h"

namespace render2mpeg::av {

/// A coded picture taken apart.
struct AccessUnit {
    std::vector<std::uint8_t> headers;   ///< parameter sets or sequence headers
    std::vector<std::uint8_t> pictures;  ///< the picture itself
    std::vector<std::uint8_t> alpha;     ///< that of VP9, which has a stream of its own; empty: none
};

/// A unit of an AV1 stream [AV1, 5.3].
struct Obu {
    std::span<const std::uint8_t> bytes, payload;  ///< all of it; without its header and size

    int type() const { return bytes[0] >> 3 & 15; }
    bool has_extension() const { return (bytes[0] & 4) != 0; }
};

/// Units with sizes, in order. Throws core::Error where one has no size that fits.
std::vector<Obu> obus_of(std::span<const std::uint8_t> bytes);

/// Splits a picture of a byte stream [H264, annex B] or, for AV1, of units with sizes [AV1, 5.2]. Mere annotations (SEI
/// messages, metadata, delimiters) are left out. Throws core::Error for other data. Not for MPEG-2.
AccessUnit taken_apart(encoder::Codec codec, std::span<const std::uint8_t> bytes);

/// Whether pictures begin with what a decoder needs before them; else their container keeps that.
bool has_byte_stream(encoder::Codec codec);

/// A picture with what its container keeps apart before it, where the codec has no byte stream of its own: a master's
/// headers, VP9's alpha. taken_apart() undoes it.
std::vector<std::uint8_t> put_together(std::span<const std::uint8_t> apart, std::span<const std::uint8_t> picture);

}  // namespace render2mpeg::av
