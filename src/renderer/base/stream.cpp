#include "renderer/base/stream.h"

namespace render2mpeg::renderer {
namespace {

/// Keeps shifts apart from numbers that are drawn.
constexpr std::uint64_t shift_key = ~std::uint64_t{0};

/// Owen's scrambling of bits below each bit by those above, by a hash [Laine2011].
std::uint32_t scrambled(std::uint32_t bits, std::uint32_t seed) {
    bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
    bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
    bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
    bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
    bits = bits << 16 | bits >> 16;
    bits += seed;
    bits ^= bits * 0x6c50b47cu;
    bits ^= bits * 0xb82f1e52u;
    bits ^= bits * 0xc7afe638u;
    bits ^= bits * 0x8d22f6e6u;
    bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
    bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
    bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
    bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
    return bits << 16 | bits >> 16;
}

}  // namespace

float Stream::halton(int dimension, std::uint64_t index) const {
    const float sum = core::halton(dimension, index) + uniform(shift_key, static_cast<std::uint64_t>(dimension));
    return sum < 1.0f ? sum : sum - 1.0f;
}

glm::vec2 Stream::sobol(std::uint32_t index) const {
    const glm::uvec2 even = core::sobol(index);
    const glm::uvec2 bits(scrambled(even.x, static_cast<std::uint32_t>(bits_)),
                          scrambled(even.y, static_cast<std::uint32_t>(bits_ >> 32)));
    return glm::vec2(bits >> 8u) * 0x1p-24f;
}

}  // namespace render2mpeg::renderer
