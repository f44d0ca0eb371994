#pragma once
// In-scattering of one lamp's light along a ray through air, shadows included.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/air.h"
#include "renderer/base/light_point.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// A lamp that air scatters light of by itself: a point, or a sun.
struct AirLamp {
    glm::vec3 position{0};
    glm::vec3 direction{0, 0, -1};          ///< unit, it shines along
    glm::vec3 intensity{0};                 ///< suns: irradiance across the beam
    float spot_scale = 0, spot_offset = 1;  ///< LightPoint
    float range = 0;                        ///< likewise
    float radius = 0;                       ///< no nearer than this counts, shadow rays end here; 0: a true point
    bool is_sun = false;
};

/// Punctual lights and suns of an instant, and round lamps that are lit by as a whole.
std::vector<AirLamp> air_lamps(std::span<const LightPoint> points, const LightTrees& light_trees);

/// A ray of the eye; light is asked for on its way as far as each of `ends`, which rise and may end in infinity.
struct AirRay {
    glm::vec3 origin{0}, direction{0, 0, -1};
    std::span<const float> ends;
    float width = 0;  ///< half of what it stands for at distance 1: no lamp is nearer to it
};

/// Surroundings of a query of light: air, occluders, and the treatment of bodies of glass.
struct AirScene {
    const Air& air;
    const RayTracer& tracer;
    Bodies bodies;
};

/// A shadow, or light between two, on a way past a lamp, in the parameter in which that lamp's light is even.
struct ThinShadow {
    std::uint16_t lamp = 0;
    float middle = 0, width = 0;
};

/// Shadows that are so thin that rays beside each other find or miss them by chance.
struct ThinShadows {
    std::uint16_t lamp = 0;
    std::span<const ThinShadow> known;  ///< of rays beside this one, of the same lamp: looked for
    std::vector<ThinShadow> found;      ///< added to
};

/// Adds to `sums`, one for each of `ray.ends`, the radiance that air on the way there scatters of the lamp's light
/// towards the ray's origin, dimmed on both ways, in shadow where anything is in the way. `cells`, 1 to 16: shadow rays
/// to begin with. `thin`: null where nothing is known of other rays. Returns the shadow rays.
std::uint64_t add_scattered(const AirScene& scene, const AirLamp& lamp, const AirRay& ray, int cells, glm::vec3* sums,
                            ThinShadows* thin = nullptr);

}  // namespace render2mpeg::renderer
