#pragma once
// Runs the program ffmpeg as the baseline encoder.
#include <string>

#include "app/experiments/trial.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// First line of `ffmpeg -version`. Throws core::Error where there is none.
std::string ffmpeg_version();

/// A way to code with ffmpeg.
struct FfmpegWay {
    std::string name;
    std::string options;  ///< `{q}`: the quantiser; `{L}`: its Lagrange factor, 118 q; `{g}`: pictures of a GOP
    std::string encoder = "mpeg2video";
};

/// Usual settings: a fixed quantiser (or crf), two B pictures, default motion search.
FfmpegWay usual_ffmpeg(encoder::Codec codec);
/// Strongest known command for long GOPs: RD decisions, trellis, UMH motion search (docs/measurements.md); for other
/// codecs the slowest preset but one.
FfmpegWay strongest_ffmpeg(encoder::Codec codec);

std::string options_of(const FfmpegWay& way, int quantiser, int gop);

/// Runs it on one thread for one window; its seconds exclude reading.
Trials::Codec ffmpeg_codec(const FfmpegWay& way, int quantiser, int gop, const core::FrameRate& rate);

}  // namespace render2mpeg::app
