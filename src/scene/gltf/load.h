#pragma once
// Loads glTF files.
#include <filesystem>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// What a .gltf or .glb file says [glTF2], not yet completed. Throws core::Error.
Animation load_gltf(const std::filesystem::path& file, const LoadOptions& options);

}  // namespace render2mpeg::scene
