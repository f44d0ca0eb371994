#pragma once
// The JSON file and the page of `compare`.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/experiments/comparison.h"

namespace render2mpeg::app {

/// Everything that `compare` found out (docs/choosing.md).
nlohmann::json compare_json(const RenderJob& film, const Comparison& found, const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_compare_report(const std::filesystem::path& html, const RenderJob& film, const Comparison& found,
                          const std::string& command);

}  // namespace render2mpeg::app
