#pragma once
// Loads a scene of any format.
#include <filesystem>
#include <optional>
#include <string>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// What the command line decides over the file.
struct LoadOptions {
    std::optional<std::string> camera;     ///< name or index
    std::optional<std::string> animation;  ///< name or index of a glTF animation; none: all of them at once
    std::optional<std::string> sky;        ///< image file, or "none"
};

/// Reads a film from .gltf, .glb, an animation file (.json), or any format that Assimp reads, checks it whole, and
/// fills in what it lacks (a camera that orbits, a neutral sky), which is said in Animation::notes. Throws core::Error
/// with file, object and cause for anything wrong.
Animation load(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace render2mpeg::scene
