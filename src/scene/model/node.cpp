#include "scene/model/node.h"

#include <cmath>

namespace render2mpeg::scene {

void separate(Node& node) {
    if (!node.matrix) return;
    const glm::dmat4& m = *node.matrix;
    glm::dmat3 axes(m);
    for (int k = 0; k < 3; ++k) {
        node.scale[k] = glm::length(axes[k]);
        axes[k] = node.scale[k] > 0 ? axes[k] / node.scale[k] : glm::dmat3(1)[k];
    }
    // A mirroring has no rotation: one axis carries it as a negative scale.
    if (glm::determinant(axes) < 0) {
        node.scale.x = -node.scale.x;
        axes[0] = -axes[0];
    }
    node.translation = glm::dvec3(m[3]);
    const glm::dquat q = glm::quat_cast(axes);
    node.rotation = glm::length(q) > 1e-9 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
    node.matrix.reset();
}

glm::dquat turn_towards(glm::dvec3 forward, glm::dvec3 up) {
    const double length = glm::length(forward);
    if (!(length > 0) || !std::isfinite(length)) return {1, 0, 0, 0};
    const glm::dvec3 z = -forward / length;
    glm::dvec3 x = glm::cross(up, z);
    // Looking along `up`: any other axis does.
    if (!(glm::length(x) > 1e-9 * glm::length(up)))
        x = glm::cross(std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1), z);
    x = glm::normalize(x);
    return glm::normalize(glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z)));
}

}  // namespace render2mpeg::scene
