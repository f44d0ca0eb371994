#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// A well-mixed 64-bit hash of a 64-bit counter. [Steele2014, SplitMix64 finaliser]
std::uint64_t mix(std::uint64_t counter);

/// Uniform in [0, 1) as a function of a seed and up to three counters; 24 bits, never 1.
float uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0, std::uint64_t c = 0);

/// The largest dimension `halton` has: one prime each.
inline constexpr int halton_dimensions = 64;

/// Element `index` of the Halton sequence in the base that is the `dimension`-th prime (0: base 2), in [0, 1).
/// Digits above the first are permuted with a fixed, seeded permutation per base, since plain high bases are correlated
/// for thousands of points. [Halton1960], [Kocis1997]
float halton(int dimension, std::uint64_t index);

/// Element `index` of Sobol's first two dimensions [Sobol1967], a (0, 2)-sequence, as bits after the point: aligned
/// runs of 4, 16 and 64 are stratified in both dimensions and jointly.
glm::uvec2 sobol(std::uint32_t index);

/// A direction about `normal` (unit) with density cos/pi, from two uniform numbers.
glm::vec3 sample_cosine_hemisphere(glm::vec3 normal, glm::vec2 u);

/// The two numbers in [0, 1) for which that gives a direction above the plane.
glm::vec2 place_of_cosine(glm::vec3 normal, glm::vec3 direction);

/// Uniform over the unit sphere.
glm::vec3 sample_sphere(glm::vec2 u);

/// Uniform over a cone about an axis (unit), by 1 - the cosine of half its angle, which keeps the digits of thin ones.
glm::vec3 sample_cone(glm::vec3 axis, float versine, glm::vec2 u);

/// Barycentrics (u, v) uniform over a triangle, of the second and third vertex.
glm::vec2 sample_triangle(glm::vec2 u);

/// Two unit vectors that make an orthonormal, right-handed frame with the unit vector n. [Duff2017]
void make_frame(glm::vec3 n, glm::vec3& tangent, glm::vec3& bitangent);

}  // namespace render2mpeg::core
