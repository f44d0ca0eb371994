#pragma once
// Opens a film with libavformat and finds its picture stream.
#include <string>

#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// A file that is open, and which of its streams the pictures are in.
struct OpenFilm {
    Input input;
    const AVStream* stream;
};

/// Opens `file` and nothing that it names. `error_recognition` is libavformat's AV_EF_ flags. Throws core::Error where
/// it cannot be read or has no video; `messages` has to listen meanwhile.
OpenFilm open_film(const std::string& file, int error_recognition, const Messages& messages);

}  // namespace render2mpeg::av
