#pragma once
// Chooses the lamps that are lit by as a whole, and says where they are.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/area_lamp.h"
#include "renderer/base/light_point.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// The lamps of a film whose unoccluded light has a closed form: suns with a size, and objects that shine evenly and
/// are one convex polygon, or one sphere that stays round (docs/model/lights.md). They take the place of their light
/// points in the light trees; photons still start from the points.
class AreaLamps {
  public:
    AreaLamps() = default;
    /// Chooses all suns with a size, and of the surfaces that `points` (the film's average light, as the posed instant
    /// shows it) belong to those that ever give much of the light. What it chooses is the same at every instant.
    AreaLamps(const PosedScene& posed_scene, std::span<const LightPoint> points);

    /// The points that are not of these lamps.
    std::vector<LightPoint> without(std::vector<LightPoint> points) const;

    /// The lamps of the posed instant that shine.
    std::vector<AreaLamp> at(const PosedScene& posed_scene) const;

  private:
    /// A surface that shines, in its mesh's space.
    struct Surface {
        std::uint32_t object = 0;
        std::vector<glm::vec3> corners;  ///< empty: a sphere
        glm::vec3 centre{0};
        float radius = 0, outer = 0;  ///< sphere: of the true one, and of the farthest corner of its mesh
    };
    AreaLamp lamp_of(const PosedScene& posed_scene, const Surface& surface) const;

    std::vector<std::uint32_t> suns_;  ///< ids of light points, rising
    std::vector<Surface> surfaces_;    ///< by object
};

/// The corners of a mesh that is one flat convex polygon with at most 8 of them, in order; empty for others.
std::vector<glm::vec3> convex_outline(const scene::Mesh& mesh);

}  // namespace render2mpeg::renderer
