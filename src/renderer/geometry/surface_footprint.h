#pragma once
// The piece of surface that a look-up stands for.
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// The piece of surface that a look-up stands for: two edges of a parallelogram about the point, world space. Parts off
/// the surface's plane are ignored. Zero: a point, textures are not filtered.
struct SurfaceFootprint {
    glm::vec3 dx{0};
    glm::vec3 dy{0};
};

}  // namespace render2mpeg::renderer
