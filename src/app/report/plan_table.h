#pragma once
// The table of passes, with their reasons and costs.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/loop/forecast.h"
#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// The plan as a table: each pass, whether it runs, why, and its cost in sample frames; null: none were lit.
std::string plan_table(const RenderJob& film, const FrameSample* sample = nullptr);

/// The plan's rows: `pass`, `runs`, `reason`, and `seconds` (CPU) or null.
nlohmann::json plan_of(const RenderJob& film, const RunStatistics& statistics);

}  // namespace render2mpeg::app
