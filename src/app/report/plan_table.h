#pragma once
// The table of passes, with their reasons and costs.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/loop/forecast.h"
#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// The plan as a table: each pass, whether it runs, why, and, if `statistics` names the file of a render, what it cost.
/// `sample`: what sample frames cost instead; null: none were lit. Throws core::Error where that file is none.
std::string plan_table(const RenderJob& film, const std::filesystem::path& statistics,
                       const FrameSample* sample = nullptr);

/// The plan's rows as plan_table() shows them: `pass`, `runs`, `reason`, and `seconds` (CPU) or null, as the statistics
/// of a render tell. Statistics may be null: not known.
nlohmann::json plan_of(const RenderJob& film, const nlohmann::json& statistics);

}  // namespace render2mpeg::app
