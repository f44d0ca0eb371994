#include "core/sampling.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::core {
namespace {

/// Bases of the sequence: the first `halton_dimensions` primes. Digits are mirrored several at a time, by tables of all
/// the numbers that so many digits can make.
struct HaltonBase {
    std::uint64_t block = 0;       ///< the largest power of the prime that is at most `most_entries`, or the prime
    std::uint64_t reciprocal = 0;  ///< floor(2^64 / block) + 1
    double inverse = 0;            ///< 1 / block
    std::vector<std::uint16_t> mirrored;  ///< of each number below `block`: its digits, permuted, the first one last
};
constexpr std::uint64_t most_entries = 4096;
/// Below, the reciprocal's rounding (at most block / 2^64 of the index) does not reach the quotient.
constexpr std::uint64_t exact_below = std::uint64_t{1} << 52;

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

HaltonBase base_of(std::uint32_t prime, int dimension) {
    const std::vector<std::uint32_t> permutation = permutation_of(prime, dimension);
    HaltonBase base;
    base.block = prime;
    while (base.block * prime <= most_entries) base.block *= prime;
    base.reciprocal = ~std::uint64_t{0} / base.block + 1;
    base.inverse = 1.0 / static_cast<double>(base.block);
    for (std::uint64_t number = 0; number < base.block; ++number) {
        std::uint64_t mirrored = 0, rest = number;
        for (std::uint64_t place = 1; place < base.block; place *= prime, rest /= prime)
            mirrored = mirrored * prime + permutation[rest % prime];
        base.mirrored.push_back(static_cast<std::uint16_t>(mirrored));
    }
    return base;
}

const std::array<HaltonBase, halton_dimensions>& bases() {
    static const std::array<HaltonBase, halton_dimensions> instance = [] {
        std::array<HaltonBase, halton_dimensions> all;
        std::array<std::uint32_t, halton_dimensions> prime{};
        int found = 0;
        for (std::uint32_t n = 2; found < halton_dimensions; ++n) {
            bool composite = false;
            for (int i = 0; i < found && prime[i] * prime[i] <= n; ++i) composite = composite || n % prime[i] == 0;
            if (composite) continue;
            all[static_cast<std::size_t>(found)] = base_of(n, found);
            prime[found++] = n;
        }
        return all;
    }();
    return instance;
}

/// index / base.block
std::uint64_t blocks_in(std::uint64_t index, const HaltonBase& base) {
    if (index >= exact_below) return index / base.block;
    return static_cast<std::uint64_t>(static_cast<unsigned __int128>(index) * base.reciprocal >> 64);
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
    const HaltonBase& base = bases()[static_cast<std::size_t>(dimension)];
    double value = 0.0, unit = 1.0;
    while (index > 0) {
        const std::uint64_t rest = blocks_in(index, base);
        value = value * static_cast<double>(base.block) + base.mirrored[index - rest * base.block];
        unit *= base.inverse;
        index = rest;
    }
    return std::min(static_cast<float>(value * unit), below_one);
}

glm::vec3 sample_cosine_hemisphere(glm::vec3 normal, glm::vec2 u) {
    glm::vec3 t, b;
    make_frame(normal, t, b);
    const float r = std::sqrt(u.x);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float z = sqrt_or_zero(1.0f - u.x);
    return r * std::cos(phi) * t + r * std::sin(phi) * b + z * normal;
}

glm::vec3 sample_sphere(glm::vec2 u) {
    const float z = 1.0f - 2.0f * u.x;
    const float r = sqrt_or_zero(1.0f - z * z);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    return {r * std::cos(phi), r * std::sin(phi), z};
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
