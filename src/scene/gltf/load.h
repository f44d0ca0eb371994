#pragma once
// Loads glTF files.
#include <cstdint>
#include <filesystem>
#include <functional>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// Loads a .gltf or .glb file [glTF2], not completed. `before_decoding`: see Document. Throws core::Error.
Animation load_gltf(const std::filesystem::path& file, const LoadOptions& options,
                    const std::function<void(std::uintmax_t)>& before_decoding = {});

}  // namespace render2mpeg::scene
