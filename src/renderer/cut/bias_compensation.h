#pragma once
// Light from surfaces very near a point: discs, and bias compensation.
#include <array>
#include <cstdint>

#include "renderer/cut/gathered_light.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_kernels.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Lights on surfaces that are nearer than this to a point, in radii of their discs, are discs to it; those farther
/// than `far_radii` are points; between, partly. chosen: 2, from where on the clamp bounds what points send, and 3.
inline constexpr float near_radii = 2.0f, far_radii = 3.0f;

/// Unoccluded irradiance at a point from unit intensity of a light on a surface, if its whole disc emits, as far as
/// that lies before the point's surface; and its weight, 0..1. Both 0 where the light is farther than far_radii.
struct DiscLight {
    float irradiance = 0, share = 0;
};
/// By lane; 0 in those that `wanted` has no bit of.
std::array<DiscLight, lane_count> disc_light(const GatherLanes& lanes, std::uint32_t wanted, const TreeLight& light);

/// Adds to what was gathered, of all light points or by a cut, what indirect light points near the lanes send as discs
/// beyond what they sent as points, clamped. Does nothing where nothing is clamped.
void compensate_clamping_bias(const LightTrees& light_trees, const RayTracer& tracer, const GatherLanes& lanes,
                              GatheredLight& out);

}  // namespace render2mpeg::renderer
