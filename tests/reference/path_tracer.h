#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::reference {

/// A mean with what is known of its error, per channel.
struct Estimate {
    glm::dvec3 mean{0};
    glm::dvec3 error{0};  ///< standard error of the mean
};

/// Light that a surface point scatters to its `outgoing`, by plain path tracing: slow, and as near to the rendering
/// equation as code can be. Directions follow the cosine, light is found by meeting what emits (surfaces, sky); only
/// punctual lights, which cannot be met, are connected to. No roulette, no clamps, sums in double. Uses the renderer's
/// rays and surfaces, none of its lights, trees, kernels or
/// scattering functions. `bounces` is how often light may scatter before it reaches
/// the point: 0 is direct light alone; what scattered less than `least_bounces` times is left out.
Estimate scattered_light(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& point, int bounces,
                         std::uint64_t samples, std::uint64_t seed, int least_bounces = 0);

}  // namespace render2mpeg::reference
