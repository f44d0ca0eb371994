#pragma once
// The counters of a run: one table adds them, writes them and reads them.
#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// Sum over two parts of one film; the earlier part's times become `earlier_cpu` and `earlier_wall`.
RunStatistics sum_of(const RunStatistics& earlier, const RunStatistics& later);

/// The statistics plus all counts of the renderer.
RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer);

/// Statistics with the frames from index `first_frame` on, in full precision, for a later run.
nlohmann::json json_of(const RunStatistics& statistics, std::size_t first_frame);

/// Reads json_of(): sums are replaced, frames added. Throws std::exception for anything else.
void restore(RunStatistics& statistics, const nlohmann::json& written);

}  // namespace render2mpeg::app
