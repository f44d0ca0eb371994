#pragma once
// Loads every other mesh format by way of Assimp.
#include <filesystem>

#include "scene/isolation/probe.h"
#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// What a file of any format says that Assimp reads (OBJ, PLY, FBX, DAE, 3DS, ...), not yet completed. `take_turns` is
/// told whose code runs. Throws core::Error.
Animation load_with_assimp(
    const std::filesystem::path& file, const LoadOptions& options, const TakeTurns& take_turns = [](Turn) {});

}  // namespace render2mpeg::scene
