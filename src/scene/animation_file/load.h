#pragma once
// Loads animation files, our own JSON.
#include <filesystem>
#include <functional>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// Reads the scene that an animation file refers to, of whatever format.
using LoadScene = std::function<Animation(const std::filesystem::path& file, const LoadOptions& options)>;

/// Our own JSON (docs/scenes.md): the scene that it refers to, which `load_scene` reads, with what it adds; not
/// yet completed. Of a folder, its film.json. Throws core::Error.
Animation load_animation_file(const std::filesystem::path& file, const LoadOptions& options,
                              const LoadScene& load_scene);

}  // namespace render2mpeg::scene
