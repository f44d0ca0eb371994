#include "renderer/base/lit_fog.h"

namespace render2mpeg::renderer {

LitFog::LitFog(glm::vec3 low, glm::vec3 high, glm::ivec3 cells)
    : low_(low), size_((high - low) / glm::vec3(cells)), cells_(cells) {
    corners_.resize(static_cast<std::size_t>(across().x) * static_cast<std::size_t>(across().y) *
                    static_cast<std::size_t>(across().z));
}

glm::vec3 LitFog::place_of(std::size_t corner) const {
    const auto number = static_cast<int>(corner);
    return low_ +
           size_ * glm::vec3(number % across().x, number / across().x % across().y, number / (across().x * across().y));
}

std::size_t LitFog::octant(glm::vec3 direction) {
    return (direction.x > 0 ? 1u : 0u) | (direction.y > 0 ? 2u : 0u) | (direction.z > 0 ? 4u : 0u);
}

glm::vec3 LitFog::light_at(glm::vec3 place) const {
    glm::vec3 light(0);
    about(place, [&](std::size_t corner, float weight) {
        light += weight * (corners_[corner].lamps + corners_[corner].rest);
    });
    return light;
}

glm::vec3 LitFog::rest_at(glm::vec3 place) const {
    glm::vec3 light(0);
    about(place, [&](std::size_t corner, float weight) { light += weight * corners_[corner].rest; });
    return light;
}

/// Leaves of [begin, end] what lies in the box, if only its border; false: nothing.
bool LitFog::clip(glm::vec3 from, glm::vec3 direction, float& begin, float& end) const {
    const glm::vec3 high = low_ + size_ * glm::vec3(cells_);
    for (int k = 0; k < 3; ++k) {
        if (direction[k] == 0.0f) {
            if (from[k] < low_[k] || from[k] > high[k]) return false;
            continue;
        }
        const float a = (low_[k] - from[k]) / direction[k], b = (high[k] - from[k]) / direction[k];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return end >= begin;
}

}  // namespace render2mpeg::renderer
