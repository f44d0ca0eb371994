#pragma once
// Unit vectors in 32 bits.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// A unit vector in 32 bits, right to 7e-5 rad: octahedral coordinates of 16 bits each. [Cigolle2014]
class PackedNormal {
  public:
    PackedNormal() = default;
    explicit PackedNormal(glm::vec3 n) {
        const float l1 = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
        if (!(l1 > 0.0f)) return;
        glm::vec2 p{n.x / l1, n.y / l1};
        if (n.z < 0.0f) p = glm::vec2{(1 - std::abs(p.y)) * sign(p.x), (1 - std::abs(p.x)) * sign(p.y)};
        x_ = quantise(p.x);
        y_ = quantise(p.y);
    }

    glm::vec3 unpack() const {
        const glm::vec3 n = unfold(x_ / 32767.0f, y_ / 32767.0f, 1.0f);
        return n / std::sqrt(glm::dot(n, n));
    }

    /// Whether the cosine between it and a unit vector exceeds `least`, without division or root: right to rounding.
    bool faces(glm::vec3 direction, float least) const {
        const glm::vec3 n = unfold(x_, y_, 32767.0f);
        const float along = glm::dot(n, direction), bound2 = least * least * glm::dot(n, n);
        return least < 0.0f ? along >= 0.0f || along * along < bound2 : along > 0.0f && along * along > bound2;
    }

    bool operator==(const PackedNormal&) const = default;

  private:
    /// On the octahedron whose corners lie at a distance of `one`.
    static glm::vec3 unfold(float x, float y, float one) {
        const float z = one - std::abs(x) - std::abs(y);
        if (z < 0.0f) return {(one - std::abs(y)) * sign(x), (one - std::abs(x)) * sign(y), z};
        return {x, y, z};
    }
    static float sign(float v) { return v < 0.0f ? -1.0f : 1.0f; }
    static std::int16_t quantise(float v) {
        return static_cast<std::int16_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 32767.0f));
    }

    std::int16_t x_ = 0;
    std::int16_t y_ = 0;
};

}  // namespace render2mpeg::core
