#pragma once
// In-scattering of one lamp's light along a ray through fog, shadows included.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/air.h"
#include "renderer/base/light_point.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Lamps that air scatters light of one by one: punctual lights and suns of an instant, and round lamps that are lit by
/// as a whole, as discs within which nothing counts and no shadow ray ends.
std::vector<LightPoint> air_lamps(std::span<const LightPoint> points, const LightTrees& light_trees);

/// A ray of the eye; light is asked for as far as each of `ends`, which rise and may end in infinity.
struct AirRay {
    glm::vec3 origin{0}, direction{0, 0, -1};
    std::span<const float> ends;
    float width = 0;  ///< half of its footprint at distance 1: no lamp is nearer to it
};

/// Surroundings of a query of light: air, geometry, and the treatment of bodies of glass.
struct AirScene {
    const Air& air;  ///< it has fog
    const RayTracer& tracer;
    Bodies bodies;
};

/// Adds to `sums`, one for each of `ray.ends`, the radiance that air before it scatters of the lamp's light
/// towards the ray's origin, dimmed on both segments, in shadow where anything is between. `cells`, 1 to 16: shadow
/// rays to begin with. Returns the shadow rays.
std::uint64_t add_scattered(const AirScene& scene, const LightPoint& lamp, const AirRay& ray, int cells,
                            glm::vec3* sums);

}  // namespace render2mpeg::renderer
