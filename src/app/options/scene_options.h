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
/// Size, rate, length, exposure and view.
void add_picture_options(CLI::App& command, RenderOptions& options);

/// A CLI11 check of --exposure. Throws core::Error.
std::string check_exposure(const std::string& text);

}  // namespace render2mpeg::app
