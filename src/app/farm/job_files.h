#pragma once
// Files by which schedulers run the parts of a plan, and the join behind them.
#include <filesystem>
#include <map>
#include <string>

#include "app/farm/farm_plan.h"

namespace render2mpeg::app {

/// Text of each file by its name. Throws core::Error where a scheduler has none.
std::map<std::filesystem::path, std::string> job_templates(const std::string& scheduler);

/// Writes the files for the plan's scheduler. Returns the script that submits all that is not made yet. Throws
/// core::Error.
std::filesystem::path write_job_files(const FarmPlan& plan);

/// Runs the script. Returns its exit status. Throws core::Error where the scheduler is not at hand.
int submit(const FarmPlan& plan, const std::filesystem::path& script);

}  // namespace render2mpeg::app
