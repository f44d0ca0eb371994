#pragma once
// Opens a file with libavformat and finds its pictures or its sound.
#include <string>

#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// A file that is open, and which of its streams was looked for.
struct OpenStream {
    Input input;
    const AVStream* stream;
};

/// Opens `file` and nothing that it names. `error_recognition` is libavformat's AV_EF_ flags. Throws core::Error where
/// it cannot be read or has no video; `messages` has to listen meanwhile.
OpenStream open_film(const std::string& file, int error_recognition, const Messages& messages);
/// The same for its first sound, or any other kind.
OpenStream open_stream(const std::string& file, AVMediaType kind, int error_recognition, const Messages& messages);

}  // namespace render2mpeg::av
