#pragma once
// Writes generated images as PNG.
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace render2mpeg::scene {

/// Uncompressed PNG of RGBA texels from the upper left; sides of at most 65,535. Throws ContractViolation for another
/// number of texels.
std::vector<std::byte> encode_png(int width, int height, std::span<const glm::u8vec4> texels);

}  // namespace render2mpeg::scene
