#pragma once
// The files that a scheduler takes, made from the templates of its name.
#include <filesystem>

#include "app/farm/farm_plan.h"

namespace render2mpeg::app {

/// Throws core::Error where the plan's scheduler has no templates, or a name cannot stand in its files. Writes nothing.
void check_job_files(const FarmPlan& plan);

/// Writes the files for the scheduler of a plan that check_job_files() has let pass. Returns the script that submits
/// all that is not made yet. Throws core::Error.
std::filesystem::path write_job_files(const FarmPlan& plan);

}  // namespace render2mpeg::app
