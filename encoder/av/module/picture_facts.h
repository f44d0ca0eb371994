#pragma once

#include "encoder/av/inspect.h"
#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// Type, field order, quantisers and vectors of a decoded picture, from the side data that libavcodec was asked for.
PictureFacts facts_of(const AVFrame& frame);

}  // namespace render2mpeg::av
