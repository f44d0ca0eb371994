#pragma once
// Points that lie evenly in the unit square.
#include <cstdint>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// Element `index` of Sobol's first two dimensions [Sobol1967], scrambled: any power of two of them in a row lie
/// evenly.
glm::vec2 net_point(std::uint32_t index, std::uint64_t seed);

/// The upper four bits of both coordinates, in turn: neighbours in the square have numbers near each other.
std::uint32_t interleaved(glm::vec2 u);

}  // namespace render2mpeg::renderer
