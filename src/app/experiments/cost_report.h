#pragma once
// The JSON file and the page of `cost`.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/experiments/film_costs.h"

namespace render2mpeg::app {

/// All results (docs/choosing.md).
nlohmann::json cost_json(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& rows,
                         const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_cost_report(const std::filesystem::path& html, const RenderJob& film, const Sweep& sweep,
                       const std::vector<FilmCost>& rows, const std::string& command);

}  // namespace render2mpeg::app
