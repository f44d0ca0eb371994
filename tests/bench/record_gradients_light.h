#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "renderer/cut/cut.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_forest.h"

namespace render2mpeg::bench {

/// What a place receives of a forest's trees, and what that changes by with place and shading normal while visibility
/// stays: from the light points, or clusters, that lit it, without further rays.
struct SlopedLight {
    glm::vec3 light{0};                                        ///< irradiance over pi
    glm::mat3 by_place{0};                                     ///< times a step, world: what it changes by
    glm::mat3 by_normal{0};                                    ///< times a change of the unit normal
    float clearance = std::numeric_limits<float>::infinity();  ///< distance of the nearest light point that reaches it
    std::vector<std::uint64_t> lit;                            ///< bit by light point; empty for cuts
};

/// Luminance by light point, as if nothing were between.
using Unshadowed = std::vector<float>;

/// From every light point. `unshadowed`, if given, is filled.
SlopedLight gather_sloped(const renderer::LightForest& forest, const renderer::RayTracer& tracer,
                          const renderer::GatherPoint& point, Unshadowed* unshadowed = nullptr);

/// From the cut that up to sixteen points share; slopes of each cluster are summed over four lights of it, as its light
/// is, with the visibility of its representative.
std::vector<SlopedLight> gather_sloped(const renderer::LightForest& forest, const renderer::RayTracer& tracer,
                                       std::span<const renderer::GatherPoint* const> points, int set,
                                       const renderer::GroupTolerance& tolerance, const renderer::CutLimits& limits);

}  // namespace render2mpeg::bench
