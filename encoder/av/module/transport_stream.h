#pragma once
// Knows transport streams by their contents.
#include <string>

#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// libavformat's format for a file that begins as a transport stream does: with a packet of 188 bytes and the sync byte
/// after another [H222, 2.4.3.2]. Null for all others, which libavformat knows by their contents; a stream of a few
/// small pictures is too short for it.
const AVInputFormat* transport_stream_format(const std::string& file);

}  // namespace render2mpeg::av
