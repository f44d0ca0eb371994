#pragma once
// The options of `tune`.
#include <CLI/CLI.hpp>

#include "app/options/options.h"

namespace render2mpeg::app {

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);

}  // namespace render2mpeg::app
