#pragma once
// A run's statistics to the last digit, for a run that resumes it.
#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// Statistics with the frames from `first_frame` (an index) on, to the last digit: what a run knows after a chunk,
/// for another run that goes on from there.
nlohmann::json json_of(const RunStatistics& statistics, std::size_t first_frame);

/// Takes in what json_of() wrote: sums replace those that are there, frames are added. Throws std::exception for
/// anything else.
void restore(RunStatistics& statistics, const nlohmann::json& written);

}  // namespace render2mpeg::app
