#pragma once
// Buffer views that are compressed by EXT_meshopt_compression.
#include <cstddef>
#include <span>
#include <vector>

#include "scene/gltf/accessor.h"

namespace render2mpeg::scene::gltf {

/// What a compressed buffer view holds. `extension` is its EXT_meshopt_compression object, `bytes` the part of the
/// buffer that it names. Refuses what does not decode, and sizes that the bytes cannot hold.
/// [EXT_meshopt_compression]
std::vector<std::byte> decode_meshopt(const Element& extension, std::span<const std::byte> bytes);

}  // namespace render2mpeg::scene::gltf
