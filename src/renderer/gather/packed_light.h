#pragma once
// Light and shares of it as places of cells keep them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/numeric.h"
#include "renderer/base/light_packing.h"

namespace render2mpeg::renderer {

inline glm::vec3 unpacked(const PackedLight& light) {
    glm::vec3 rgb;
    light.unpack(rgb.x, rgb.y, rgb.z);
    return rgb;
}

/// Shares of 0..1.
inline std::array<std::uint8_t, 3> packed_share(glm::vec3 share) {
    const auto packed = [](float s) { return static_cast<std::uint8_t>(std::clamp(255.0f * s + 0.5f, 0.0f, 255.0f)); };
    return {packed(share.x), packed(share.y), packed(share.z)};
}
inline glm::vec3 unpacked_share(const std::array<std::uint8_t, 3>& share) {
    return glm::vec3(share[0], share[1], share[2]) / 255.0f;
}

/// Light over the strength of its source; 0 where that is.
inline glm::vec3 over(glm::vec3 light, glm::vec3 strength) {
    for (int k = 0; k < 3; ++k) light[k] = core::divide_or(light[k], strength[k], 0.0f);
    return light;
}

}  // namespace render2mpeg::renderer
