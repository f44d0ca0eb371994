#pragma once
// Runs the program ffmpeg as the baseline encoder.
#include <string>
#include <vector>

#include "app/experiments/trial.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// First line of what the program `ffmpeg` says of itself. Throws core::Error where there is none.
std::string ffmpeg_version();

/// A way to code with ffmpeg.
struct FfmpegWay {
    std::string name;
    std::string options;  ///< `{q}`: the quantiser; `{L}`: its Lagrange factor, 118 q; `{g}`: pictures of a GOP
    std::string encoder = "mpeg2video";
};

/// As people use it: a fixed quantiser, two B pictures, motion search as it is by default; other codecs by crf.
FfmpegWay usual_ffmpeg(encoder::Codec codec);
/// The strongest command known for closed GOPs of so many pictures: rate-distortion decisions, trellis, and motion
/// search by uneven hexagons (docs/measurements.md). Of other codecs the slowest preset but one.
FfmpegWay strongest_ffmpeg(encoder::Codec codec);
/// The strongest for free GOPs: longer ones, in which it chooses where B pictures pay.
FfmpegWay strongest_free_ffmpeg(encoder::Codec codec);

/// The options of a way with its values in place.
std::string options_of(const FfmpegWay& way, int quantiser, int gop);

/// Runs it on one thread for one window. What only reading the pictures takes is no part of its seconds. Where the
/// stream has one I picture more than GOPs of `gop` pictures ask for, what that costs more than a P picture does not
/// count, in ffmpeg's favour.
Trials::Codec ffmpeg_codec(const FfmpegWay& way, int quantiser, int gop, const core::FrameRate& rate);

}  // namespace render2mpeg::app
