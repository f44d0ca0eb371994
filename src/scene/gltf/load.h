#pragma once
// Loads glTF files.
#include <cstdint>
#include <filesystem>
#include <functional>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// What a .gltf or .glb file says [glTF2], not yet completed. `before_decoding` is called before the first compressed
/// mesh, with how many bytes the file and its buffers have; what it throws ends the reading. Throws core::Error.
Animation load_gltf(const std::filesystem::path& file, const LoadOptions& options,
                    const std::function<void(std::uintmax_t)>& before_decoding = {});

}  // namespace render2mpeg::scene
