#pragma once
// Loads animation files, our own JSON.
#include <filesystem>
#include <functional>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

using LoadScene = std::function<Animation(const std::filesystem::path& file, const LoadOptions& options)>;

/// An animation file (docs/scenes.md), or the film.json of a folder, on the scene that `load_scene` reads; not
/// completed. Throws core::Error.
Animation load_animation_file(const std::filesystem::path& file, const LoadOptions& options,
                              const LoadScene& load_scene);

}  // namespace render2mpeg::scene
