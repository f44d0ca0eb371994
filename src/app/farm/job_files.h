#pragma once
// Files by which schedulers run the parts of a plan, and the join behind them.
#include <filesystem>
#include <string>
#include <vector>

#include "app/farm/farm_plan.h"

namespace render2mpeg::app {

/// One of them.
struct JobFile {
    std::string name;  ///< in the plan's folder
    std::string text;
    bool runs = false;  ///< it is a script
};

/// What a scheduler needs. One of them is `submit.sh`.
std::vector<JobFile> batch_job_files(const FarmPlan& plan);    ///< slurm, sge, parallel
std::vector<JobFile> service_job_files(const FarmPlan& plan);  ///< the others

/// What was written.
struct JobFiles {
    std::filesystem::path script;  ///< submits all that is not made yet
    std::string needs;             ///< the program that it calls
    std::string how;               ///< for people: what to do with it
};

/// Writes the files for the plan's scheduler. Throws core::Error.
JobFiles write_job_files(const FarmPlan& plan);

/// Runs the script. Returns its exit status. Throws core::Error where the scheduler is not at hand.
int submit(const FarmPlan& plan, const JobFiles& files);

/// A line of a shell script that says where the program and the plan are: `program` and `plan` are set behind it.
std::string places_text(const FarmPlan& plan);

}  // namespace render2mpeg::app
