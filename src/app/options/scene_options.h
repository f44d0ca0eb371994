#pragma once

#include <string>

#include "app/options/coding_options.h"

namespace render2mpeg::app {

void add_scene_options(CLI::App& command, RenderOptions& options);
void add_effort_option(CLI::App& command, RenderOptions& options);
/// Options of picture, light and coding.
void add_film_options(CLI::App& command, RenderOptions& options);

}  // namespace render2mpeg::app
