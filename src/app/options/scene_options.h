#pragma once

#include <string>

#include "app/options/coding_options.h"

namespace render2mpeg::app {

void add_scene_options(CLI::App& command, RenderOptions& options);
void add_tolerance_option(CLI::App& command, RenderOptions& options, const std::string& group);
void add_light_options(CLI::App& command, RenderOptions& options);
void add_picture_options(CLI::App& command, RenderOptions& options);
void add_effort_option(CLI::App& command, RenderOptions& options);
/// Options of picture, light and coding.
void add_film_options(CLI::App& command, RenderOptions& options);

std::string check_exposure(const std::string& text);

}  // namespace render2mpeg::app
