#pragma once

#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg tune`: finds the setting that reaches a quality, rate, size or time on a sample of the film, then makes
/// the film (docs/tune.md). `words` are the command line's. Returns the exit status: 0; 1 where the target is out of
/// reach or the film missed it; 130 after an interruption. Throws core::Error.
int tune(const TuneOptions& options, const std::vector<std::string>& words);

}  // namespace render2mpeg::app
