#pragma once
// Shading normals that make sense beside the triangle's. All vectors are unit; the geometric normal is on the side of
// `outgoing`.
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/numeric.h"

namespace render2mpeg::renderer {

/// A shading normal that `outgoing` and the geometric normal both see: below the horizon it would be black.
inline glm::vec3 turned_to_viewer(glm::vec3 normal, glm::vec3 geometric, glm::vec3 outgoing) {
    // chosen: about half a degree above the horizon; tried 0.001..0.1, black rims at silhouettes come back below 0.005.
    constexpr float least_cosine = 0.01f;
    glm::vec3 n = glm::dot(normal, geometric) > 0.0f ? normal : geometric;
    const float cosine = glm::dot(n, outgoing);
    if (cosine >= least_cosine) return n;
    n = core::normalize_or(n + (least_cosine - cosine) * outgoing, geometric);
    return glm::dot(n, geometric) > 0.0f ? n : geometric;
}

/// The normal nearest to this one, in its plane with the geometric one, at which `outgoing` is mirrored to above the
/// triangle. With z along the geometric normal and x across, at an angle t to z the mirrored direction has the height
///     x sin 2t + z cos 2t = |(x, z)| cos(2t - atan(x / z)).
inline glm::vec3 turned_to_mirror(glm::vec3 normal, glm::vec3 geometric, glm::vec3 outgoing) {
    // chosen: Cycles' own, since films are to look alike.
    constexpr float least_height = 0.01f, of_outgoing = 0.9f;
    const float z = glm::dot(outgoing, geometric), along = glm::dot(normal, geometric);
    const float least = std::min(of_outgoing * z, least_height);
    if (2.0f * glm::dot(normal, outgoing) * along - z >= least) return normal;
    const glm::vec3 across = core::normalize_or(normal - along * geometric, glm::vec3(0));
    const float x = glm::dot(outgoing, across), length = std::hypot(x, z);
    const float t =
        0.5f * (std::atan2(x, z) + std::acos(std::clamp(core::divide_or(least, length, 1.0f), -1.0f, 1.0f)));
    return core::normalize_or(std::sin(t) * across + std::cos(t) * geometric, geometric);
}

}  // namespace render2mpeg::renderer
