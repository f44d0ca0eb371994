#pragma once

#include "core/plane.h"
#include "encoder/av/inspect.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/types.h"

namespace render2mpeg::av {

/// Type, field order, quantisers and vectors of a decoded picture, from the side data that libavcodec was asked for.
PictureFacts facts_of(const AVFrame& frame, encoder::Codec codec);

/// Quantiser and mode of each macroblock of a decoded picture, where the decoder tells them; else empty.
core::Plane<encoder::MacroblockRecord> macroblocks_of(const AVFrame& frame);

}  // namespace render2mpeg::av
