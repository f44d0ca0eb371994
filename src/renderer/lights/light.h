#pragma once
// Anything that shines, as whoever follows paths asks it: the interface of all kinds of light.
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "core/surface_address.h"
#include "renderer/base/area_lamp.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Where a path asks for light.
struct LightQuery {
    glm::vec3 position{0};  ///< of the surface
    glm::vec3 origin{0};    ///< where rays leave it
    glm::vec3 normal{0};    ///< light from behind it is none; 0: light comes from all sides

    /// Whether light may come from a place at `to` with so large a radius about it.
    bool may_see(glm::vec3 to, float radius = 0.0f) const {
        return normal == glm::vec3(0) || glm::dot(to, normal) > -radius;
    }
};

/// Extent and power of a source.
struct SourceExtent {
    glm::vec3 centre{0};
    float radius = 0;
    double power = 0;      ///< > 0, irradiance x distance^2; of distant ones irradiance
    bool distant = false;  ///< like a sun: it has no place
};

/// Light from one direction. What a surface scatters of it: f_s cos x `light`, if nothing is in the way.
struct LightSample {
    glm::vec3 light{0};  ///< radiance over `density`, or irradiance across the beam over the chance of the choice
    glm::vec3 direction{0, 0, 1};  ///< unit, to the light
    glm::vec3 ray{0, 0, 1};        ///< the shadow ray's, from the query's origin
    float far = 0;                 ///< where that ends, in units of `ray`
    float density = 0;             ///< of choosing the direction, per steradian; 0: rays cannot meet the light
};

/// A light of the posed instant.
class Light {
  public:
    virtual ~Light() = default;

    /// Where it lies, and its power.
    virtual SourceExtent extent() const = 0;
    /// About its irradiance, if nothing is in the way; 0 where none of it can reach the query.
    virtual double weight(const LightQuery& query) const = 0;
    /// A direction to it by three numbers in [0, 1), the first of which chooses a part of it.
    virtual LightSample sample(const LightQuery& query, double part, glm::vec2 u) const = 0;
    /// Density of `sample` in a direction (unit) in which it is met, surfaces at this address; 0: it cannot be met.
    virtual float density(const LightQuery&, glm::vec3, const core::SurfaceAddress&) const { return 0; }
    /// Whose surface it is; no_id: nobody's.
    virtual std::uint32_t object() const { return core::no_id; }
    /// Radiance of what is far from this direction (unit).
    virtual glm::vec3 radiance(glm::vec3) const { return glm::vec3(0); }

    /// As light trees have it, where it is one point.
    virtual std::optional<LightPoint> point() const { return std::nullopt; }
    /// As a lamp that is lit by as a whole, where its object is not what decides; null: it is none.
    virtual std::shared_ptr<AreaLamp> whole() const { return nullptr; }
};

using Lights = std::vector<std::unique_ptr<Light>>;

// The kinds, a file each: of one lamp without a surface,
std::unique_ptr<Light> punctual_light(const scene::LightState& lamp);
/// A point without direction that stands for a flame,
std::unique_ptr<Light> flame_light(const LightPoint& point);
std::unique_ptr<Light> sun_light(const scene::LightState& lamp);
/// all of them that shine at an instant,
Lights lamps_of(const scene::Snapshot& instant);
/// those and the flames of its volumes,
Lights lamps_of(const PosedScene& posed_scene);
/// all surfaces that shine, each of one object (mesh_light.cpp),
Lights surfaces_of(const PosedScene& posed_scene);
/// and the sky, unless it has one colour (sky_light.cpp).
Lights skies_of(const PosedScene& posed_scene);
/// What the light points of all lamps have.
LightPoint point_of_lamp(const scene::LightState& lamp);

}  // namespace render2mpeg::renderer
