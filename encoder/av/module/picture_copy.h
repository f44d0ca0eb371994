#pragma once
// Pictures out of libavcodec's frames and into them.
#include "core/picture.h"
#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// A decoded frame's samples, rounded to 8 bits and to 4:2:0. The frame is_known().
core::Picture picture_of(const AVFrame& frame, std::int64_t number);

/// Whether picture_of() takes such frames: planes of Y'CbCr with 8 to 12 bits.
bool is_known(const AVFrame& frame);

/// Fills a frame, whose buffers are there and writable, with a picture. 4:2:0 of 10 bits has four times the values,
/// luma dithered where the picture has it unrounded; all chroma, and luma of 4:2:2 and 4:4:4, is the nearest to
/// unrounded values.
void fill(AVFrame& frame, const core::Picture& picture);

}  // namespace render2mpeg::av
