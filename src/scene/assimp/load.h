#pragma once
// Loads every other mesh format by way of Assimp.
#include <filesystem>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// Loads any format of Assimp's (OBJ, PLY, FBX, DAE, 3DS, ...), not completed. Throws core::Error.
Animation load_with_assimp(const std::filesystem::path& file, const LoadOptions& options);

}  // namespace render2mpeg::scene
