#pragma once
// A lamp that is lit by as a whole: a flat or round surface that shines evenly, or a sun with a size.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace render2mpeg::renderer {

/// A lamp whose unoccluded irradiance has a closed form, so that only the share of it that is visible must be sampled
/// (docs/model/lights.md).
struct AreaLamp {
    enum class Kind : std::uint8_t { polygon, sphere, sun };

    Kind kind = Kind::polygon;
    bool two_sided = false;          ///< polygon: shines from its back as well
    bool sharp = false;              ///< its shadows are too sharp to be interpolated between places
    std::uint32_t object = 0;        ///< whose surface it is; suns: none
    std::vector<glm::vec3> corners;  ///< polygon: convex, in order, world
    glm::vec3 position{0};           ///< sphere: centre; sun: unit direction towards it
    glm::vec3 normal{0, 0, 1};       ///< polygon: unit, of its front
    float radius = 0;                ///< sphere: of the true sphere; sun: sine of half the angle it spans
    float clearance = 0;             ///< shadow rays end so far before the surface, scene units
    float area = 0;                  ///< polygon, sphere
    glm::vec3 radiance{0};
};

}  // namespace render2mpeg::renderer
