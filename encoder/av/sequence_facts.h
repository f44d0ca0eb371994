#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/rational.h"
#include "encoder/types.h"

/// Reads a container's facts about an MPEG-2 stream from the headers before its first picture.
namespace render2mpeg::av {

/// Facts about an MPEG-2 video stream for its container, from the headers before its first picture.
struct SequenceFacts {
    std::vector<std::uint8_t> headers;  ///< sequence header and all that follows up to the first GOP or picture
    int width = 0, height = 0;
    core::Rational pixel_aspect{1, 1};  ///< width by height of a pixel
    core::FrameRate rate;               ///< as declared; shown pictures per second where no field is repeated
    std::int64_t bit_rate = 0;          ///< bits per second
    std::int64_t buffer_bits = 0;       ///< vbv_buffer_size
    bool progressive = false;
    int decoding_delay = 1;   ///< pictures between decoding and showing; 0: there are no B pictures
    int color_primaries = 2;  ///< [H262, tables 6-7 to 6-9]; 2: not said
    int transfer_characteristics = 2;
    int matrix_coefficients = 2;
    std::size_t largest_picture = 0;              ///< bytes; not in the stream: known or estimated by who writes it
    std::string timecode;                         ///< likewise; empty: none
    std::vector<encoder::Chapter> chapters = {};  ///< likewise, by fields in place of pictures
};

/// Reads the sequence header, sequence extension and sequence display extension at the start of `picture`
/// [H262, 6.2.2]. Throws core::Error if it does not start with an MPEG-2 sequence.
SequenceFacts read_sequence(std::span<const std::uint8_t> picture);

}  // namespace render2mpeg::av
