#pragma once
// Loads a scene of any format.
#include <filesystem>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

/// How a film's scene is read: the only place that knows all formats.
namespace render2mpeg::scene {

/// Reads a film from .gltf, .glb, an animation file (.json), .blend (by way of Blender), or any format that Assimp
/// reads, checks it whole, and fills in what it lacks (a camera that turns about it, a studio), which is said in
/// Animation::notes. Throws core::Error with file, object and cause for anything wrong.
Animation load(const std::filesystem::path& file, const LoadOptions& options = {});

/// What a file says, by the ending of its name, not yet completed (preparation/complete.h). Throws core::Error, also
/// for a file that is not there.
Animation load_as_is(const std::filesystem::path& file, const LoadOptions& options);

}  // namespace render2mpeg::scene
