#pragma once
// The options of `tune`.
#include "app/options/coding_options.h"

namespace render2mpeg::app {

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);

}  // namespace render2mpeg::app
