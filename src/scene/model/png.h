#pragma once
// Writes images that an animation file describes as PNG.
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace render2mpeg::scene {

/// A PNG of 8-bit RGBA texels, row by row from the upper left, stored without compression: how images that a file
/// describes instead of holding them (patterns, plain texels) become an ImageSource. Throws ContractViolation where the
/// sizes do not agree.
std::vector<std::byte> encode_png(int width, int height, std::span<const glm::u8vec4> texels);

}  // namespace render2mpeg::scene
