#pragma once
// Buffer views that are compressed by EXT_meshopt_compression.
#include <cstddef>
#include <span>
#include <vector>

#include "scene/gltf/accessor.h"

namespace render2mpeg::scene::gltf {

/// Decodes a buffer view. `extension`: its object; `bytes`: the compressed part. Refuses damage and impossible sizes.
/// [EXT_meshopt_compression]
std::vector<std::byte> decode_meshopt(const Element& extension, std::span<const std::byte> bytes);

}  // namespace render2mpeg::scene::gltf
