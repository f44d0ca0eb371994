#pragma once
// Options of the commands that begin with frames or films instead of a scene.
#include "app/options/coding_options.h"

namespace render2mpeg::app {

CLI::App* add_encode_command(CLI::App& app, EncodeOptions& options);
CLI::App* add_info_command(CLI::App& app, InfoOptions& options);

}  // namespace render2mpeg::app
