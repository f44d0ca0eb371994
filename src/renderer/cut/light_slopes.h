#pragma once

#include "renderer/tree/light_kernels.h"

namespace render2mpeg::renderer {

/// What irradiance at each lane changes by with its place and with its unit normal, world, while visibility stays: a
/// vector by colour channel.
struct alignas(64) SlopeLanes {
    Vec3Lanes by_place[3], by_normal[3];
};

/// Adds a light's, of which `visible` is seen from each lane, by channel.
void add_slopes(const GatherLanes& lanes, LightFamily family, const StandIn& light, GeometryClamp clamp,
                const Vec3Lanes& visible, SlopeLanes& out);

}  // namespace render2mpeg::renderer
