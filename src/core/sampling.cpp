#include "core/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::core {
namespace {

struct HaltonBase {
    std::uint32_t prime = 2;
    std::vector<std::uint32_t> permutation;  ///< of its digits
};

/// A permutation of the digits 0..prime-1: of all but 0, so that the infinite tail of zeros adds nothing. Bases 2 and 3
/// stay plain.
std::vector<std::uint32_t> permutation_of(std::uint32_t prime, int dimension) {
    std::vector<std::uint32_t> permutation(prime);
    std::iota(permutation.begin(), permutation.end(), 0u);
    if (dimension < 2) return permutation;
    for (std::uint32_t i = prime - 1; i > 1; --i) {
        const std::uint64_t j = 1 + mix((static_cast<std::uint64_t>(dimension) << 32) | i) % i;
        std::swap(permutation[i], permutation[j]);
    }
    return permutation;
}

const std::array<HaltonBase, halton_dimensions>& bases() {
    static const std::array<HaltonBase, halton_dimensions> instance = [] {
        std::array<HaltonBase, halton_dimensions> all;
        int found = 0;
        for (std::uint32_t n = 2; found < halton_dimensions; ++n) {
            if (std::any_of(all.begin(), all.begin() + found, [&](const HaltonBase& b) { return n % b.prime == 0; }))
                continue;
            all[static_cast<std::size_t>(found)] = {n, permutation_of(n, found)};
            ++found;
        }
        return all;
    }();
    return instance;
}

constexpr float below_one = 0x1.fffffep-1f;

}  // namespace

std::uint64_t mix(std::uint64_t counter) {
    std::uint64_t z = counter + 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

float uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    const std::uint64_t h = mix(mix(mix(mix(seed) ^ a) ^ b) ^ c);
    return static_cast<float>(h >> 40) * 0x1p-24f;
}

float halton(int dimension, std::uint64_t index) {
    EXPECTS(dimension >= 0 && dimension < halton_dimensions);
    const auto& [prime, permutation] = bases()[static_cast<std::size_t>(dimension)];
    double value = 0.0, unit = 1.0;
    for (; index > 0; index /= prime) {
        value = value * prime + permutation[index % prime];
        unit /= prime;
    }
    return std::min(static_cast<float>(value * unit), below_one);
}

glm::uvec2 sobol(std::uint32_t index) {
    glm::uvec2 bits(0);
    std::uint32_t first = 1u << 31, second = 1u << 31;
    for (; index != 0; index >>= 1, first >>= 1, second ^= second >> 1)
        if ((index & 1u) != 0) bits ^= glm::uvec2(first, second);
    return bits;
}

glm::vec3 sample_cosine_hemisphere(glm::vec3 normal, glm::vec2 u) {
    glm::vec3 t, b;
    make_frame(normal, t, b);
    const float r = std::sqrt(u.x);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float z = sqrt_or_zero(1.0f - u.x);
    return r * std::cos(phi) * t + r * std::sin(phi) * b + z * normal;
}

glm::vec2 place_of_cosine(glm::vec3 normal, glm::vec3 direction) {
    constexpr float below_one = 0x1.fffffep-1f;
    glm::vec3 t, b;
    make_frame(normal, t, b);
    const float x = glm::dot(t, direction), y = glm::dot(b, direction),
                turn = std::atan2(y, x) * (0.5f * std::numbers::inv_pi_v<float>);
    return glm::clamp(glm::vec2(x * x + y * y, turn < 0.0f ? turn + 1.0f : turn), 0.0f, below_one);
}

glm::vec3 sample_sphere(glm::vec2 u) {
    const float z = 1.0f - 2.0f * u.x;
    const float r = sqrt_or_zero(1.0f - z * z);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    return {r * std::cos(phi), r * std::sin(phi), z};
}

glm::vec3 sample_cone(glm::vec3 axis, float versine, glm::vec2 u) {
    glm::vec3 t, b;
    make_frame(axis, t, b);
    const float down = u.x * versine, phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float sine = sqrt_or_zero(down * (2.0f - down));
    return normalize_or((1.0f - down) * axis + sine * (std::cos(phi) * t + std::sin(phi) * b), axis);
}

glm::vec2 sample_triangle(glm::vec2 u) {
    const float s = std::sqrt(u.x);
    return {s * (1.0f - u.y), s * u.y};
}

void make_frame(glm::vec3 n, glm::vec3& tangent, glm::vec3& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace render2mpeg::core
