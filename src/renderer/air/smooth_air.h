#pragma once
// Light that air scatters of surfaces that shine, and of light trees' bounced light.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Light trees, some of them, for light that is smooth in air.
struct SmoothAirLight {
    SmoothAirLight() = default;
    /// Of these light trees and direct light points without points, spots, suns and round lamps; `bounces`: with
    /// bounced light.
    SmoothAirLight(const LightTrees& light_trees, std::span<const LightPoint> points, bool bounces);

    LightTrees trees;
    bool shines = false;

    /// Adds mean radiance over all directions at places to `light`, which is off by a share of that and of `known`, the
    /// luminance that they have already. Returns the shadow rays.
    std::uint64_t add(const RayTracer& tracer, std::span<const glm::vec3> places, std::span<const float> known,
                      std::span<glm::vec3> light) const;
};

}  // namespace render2mpeg::renderer
