#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/options/coding_options.h"

/// Options of the commands that begin with a scene, by what they decide.
namespace render2mpeg::app {

/// What is seen and lit.
void add_scene_options(CLI::App& command, RenderOptions& options);
void add_tolerance_option(CLI::App& command, RenderOptions& options, const std::string& group);
/// How light is gathered, --tolerance included.
void add_light_options(CLI::App& command, RenderOptions& options);
/// Size, rate, length and exposure.
void add_picture_options(CLI::App& command, RenderOptions& options);

/// Commands that try a film instead of making it.
CLI::App* add_cost_command(CLI::App& app, CostOptions& options);
CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);
CLI::App* add_compare_command(CLI::App& app, CompareOptions& options);

/// Threads, JSON, report, where references are kept, and silence of such a command (CostOptions, TuneOptions,
/// CompareOptions).
template <class Options>
void add_trial_run_options(CLI::App& command, Options& options);

/// A CLI11 check of --exposure. Throws core::Error.
std::string check_exposure(const std::string& text);

}  // namespace render2mpeg::app
