#include "renderer/gather/net_points.h"

namespace render2mpeg::renderer {
namespace {

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

glm::vec2 net_point(std::uint32_t index, std::uint64_t seed) {
    std::uint32_t x = 0, y = 0, first = 1u << 31, second = 1u << 31;
    for (; index != 0; index >>= 1, first >>= 1, second ^= second >> 1) {
        if ((index & 1u) == 0) continue;
        x ^= first;
        y ^= second;
    }
    const glm::uvec2 bits(scrambled(x, static_cast<std::uint32_t>(seed)),
                          scrambled(y, static_cast<std::uint32_t>(seed >> 32)));
    return glm::vec2(bits >> 8u) * 0x1p-24f;
}

std::uint32_t interleaved(glm::vec2 u) {
    const auto x = static_cast<std::uint32_t>(16.0f * u.x), y = static_cast<std::uint32_t>(16.0f * u.y);
    std::uint32_t bits = 0;
    for (unsigned b = 0; b < 4; ++b) bits |= (x >> b & 1u) << (2 * b) | (y >> b & 1u) << (2 * b + 1);
    return bits;
}

}  // namespace render2mpeg::renderer
