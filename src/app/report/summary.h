#pragma once
// The summary that a render prints.
#include <string>

#include "app/report/statistics.h"

namespace render2mpeg::app {

/// The lines a user reads at the end of a render, and of encoding frames from outside.
std::string summary(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts);
std::string encode_summary(const Film& film, const RunStatistics& statistics, const RunFacts& facts);

}  // namespace render2mpeg::app
