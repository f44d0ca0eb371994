#pragma once
// An axis-aligned box.
#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace render2mpeg::core {

/// As it stands, it holds nothing.
struct Box {
    glm::vec3 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};

    void hold(glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
    static Box about(const std::vector<glm::vec3>& points) {
        Box box;
        for (const glm::vec3& p : points) box.hold(p);
        return box;
    }
    bool any() const { return low.x <= high.x; }
    glm::vec3 size() const { return high - low; }
    glm::vec3 middle() const { return 0.5f * (low + high); }
    int longest_axis() const {
        const glm::vec3 s = size();
        return s.x >= s.y && s.x >= s.z ? 0 : s.y >= s.z ? 1 : 2;
    }
    /// One of eight: bit k says which end of axis k.
    glm::vec3 corner(int c) const {
        return {(c & 1) != 0 ? high.x : low.x, (c & 2) != 0 ? high.y : low.y, (c & 4) != 0 ? high.z : low.z};
    }
};

}  // namespace render2mpeg::core
