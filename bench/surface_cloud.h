#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace render2mpeg::bench {

/// Points of a posed scene, met by random lines through a ball about it: as dense everywhere, per area and per volume.
struct SurfaceCloud {
    std::vector<glm::vec3> places, normals;  ///< on surfaces; normals are unit
    std::vector<glm::vec3> inside;           ///< within closed things: between a front and the back behind it
    float area = 0;                          ///< of all surfaces, about
    glm::vec3 middle{0};
    float radius = 0;  ///< of the ball
};

}  // namespace render2mpeg::bench
