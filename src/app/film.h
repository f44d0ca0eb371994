#pragma once

#include <cstdint>
#include <string>

#include "app/options.h"
#include "core/rational.h"
#include "encoder/encoder.h"

namespace render2mpeg::app {

/// What a coded film is, wherever its pictures come from.
struct Film {
    std::string source;  ///< file that the pictures are made from
    FrameRange frames;
    encoder::Settings coding;
    std::string isa;  ///< instruction set that the pictures depend on; empty: on none

    std::int64_t frame_count() const { return frames.last - frames.first + 1; }
};

/// The encoder's settings for pictures of this size and rate, square pixels, and the matrix that their height asks for.
encoder::Settings coding_settings(const CodingOptions& options, Size size, const core::FrameRate& rate);

}  // namespace render2mpeg::app
