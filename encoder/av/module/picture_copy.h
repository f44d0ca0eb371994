#pragma once
// Pictures out of libavcodec's frames and into them.
#include "core/picture.h"
#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// A decoded frame's samples; those of 10 bits are rounded to 8. The frame is 4:2:0 (is_4_2_0).
core::Picture picture_of(const AVFrame& frame, std::int64_t number);

/// Whether picture_of() takes such frames.
bool is_4_2_0(const AVFrame& frame);

/// Fills a frame, whose buffers are there and writable, with a picture: with 10 bits four times the values, and luma
/// dithered where the picture has it unrounded.
void fill(AVFrame& frame, const core::Picture& picture);

}  // namespace render2mpeg::av
