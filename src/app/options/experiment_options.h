#pragma once
// The options of `cost` and `compare`, and those that all commands share that try a film instead of making it.
#include "app/options/coding_options.h"

namespace render2mpeg::app {

CLI::App* add_cost_command(CLI::App& app, CostOptions& options);
CLI::App* add_compare_command(CLI::App& app, CompareOptions& options);

/// Threads, JSON, report, folder of references, and silence of such a command.
void add_trial_run_options(CLI::App& command, TrialOptions& options);

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);

}  // namespace render2mpeg::app
