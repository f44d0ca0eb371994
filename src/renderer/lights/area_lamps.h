#pragma once
// Chooses the lamps that are lit by as a whole, and says where they are.
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "renderer/base/area_lamp.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// How an object lies at an instant.
struct LampPose {
    glm::mat4 to_world{1};
    glm::vec3 normal{0, 0, 1};  ///< unit, of its first triangle's front
    float clearance = 0;        ///< shadow rays end so far before its surface, scene units
};

/// The lamp that an object is at an instant; empty: it is none of that kind.
using LampShape = std::function<std::shared_ptr<AreaLamp>(const LampPose&)>;

/// The kinds of meshes that may be lamps: one flat convex polygon, and one sphere, whole and once, that is scaled
/// evenly in all instants.
LampShape polygon_shape(const scene::Mesh& mesh, bool two_sided, bool stays_round);
LampShape sphere_shape(const scene::Mesh& mesh, bool two_sided, bool stays_round);
inline constexpr std::array lamp_shapes{polygon_shape, sphere_shape};

/// A sphere, world; shadow rays end `clearance` before it.
std::shared_ptr<AreaLamp> sphere_lamp(glm::vec3 centre, float radius, float clearance);

/// Irradiance of a convex polygon of radiance 1 at a place with this unit normal, clipped to the horizon: half the sum
/// of the angles that its edges span, each times the normal's component across it [Lambert1760]. At least 0; 0 in the
/// polygon's plane. The polygon's order does not matter.
double polygon_irradiance(std::span<const glm::vec3> corners, glm::vec3 place, glm::vec3 normal);

/// The corners of a mesh that is one flat convex polygon with at most 8 of them, in order; empty for others.
std::vector<glm::vec3> convex_outline(const scene::Mesh& mesh);

/// Of a mesh's size: how far a corner may lie off the plane, or from the sphere.
inline constexpr float shape_error = 1e-3f;

/// Normal of a triangle by its winding, as long as twice its area; in the mesh's space.
inline glm::vec3 wound_normal(const scene::Mesh& mesh, glm::uvec3 t) {
    const glm::vec3 a = mesh.positions[t.x];
    return glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
}

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
    std::vector<std::shared_ptr<const AreaLamp>> at(const PosedScene& posed_scene) const;

  private:
    bool suns_ = false;                            ///< those with a size
    std::map<std::uint32_t, LampShape> surfaces_;  ///< by object
};

}  // namespace render2mpeg::renderer
