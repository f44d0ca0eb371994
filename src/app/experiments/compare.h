#pragma once

#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg compare`: the same frames by this program and by rendering first and encoding with ffmpeg then
/// (docs/choosing.md). Returns the exit status: 0, or 130 after an interruption, with what was finished until then.
/// Throws core::Error, also where there is no ffmpeg.
int compare(const CompareOptions& options, const std::vector<std::string>& words);

}  // namespace render2mpeg::app
