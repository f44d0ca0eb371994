#pragma once
// The counters of a run: one table adds them, writes them and reads them.
#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// Sum of runs over parts of one film, the earlier part first; their times are in its `earlier_cpu` and
/// `earlier_wall`.
RunStatistics sum_of(const RunStatistics& earlier, const RunStatistics& later);

/// The statistics plus all counts of the renderer.
RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer);

/// Statistics with the frames from `first_frame` (an index) on, to the last digit: what a run knows after a chunk,
/// for another run that goes on from there.
nlohmann::json json_of(const RunStatistics& statistics, std::size_t first_frame);

/// Takes in what json_of() wrote: sums replace those that are there, frames are added. Throws std::exception for
/// anything else.
void restore(RunStatistics& statistics, const nlohmann::json& written);

}  // namespace render2mpeg::app
