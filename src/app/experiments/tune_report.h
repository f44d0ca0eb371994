#pragma once
// The JSON file and the page of `tune`.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/experiments/tuning.h"
#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// Everything that `tune` found out (docs/tune.md).
nlohmann::json tune_json(const RenderJob& film, const Tuning& tuning, const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_tune_report(const std::filesystem::path& html, const RenderJob& film, const Tuning& tuning,
                       const std::string& command);

}  // namespace render2mpeg::app
