#pragma once
// Options of commands that try a film.
#include "app/options/coding_options.h"

namespace render2mpeg::app {

CLI::App* add_cost_command(CLI::App& app, CostOptions& options);
CLI::App* add_compare_command(CLI::App& app, CompareOptions& options);

/// Options of the run: threads, JSON, report, references.
void add_trial_run_options(CLI::App& command, TrialOptions& options);

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);

}  // namespace render2mpeg::app
