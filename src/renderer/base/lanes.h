#pragma once
// Arrays of sixteen values, as loops take them that become vector code.
#include <glm/glm.hpp>

#include "core/sampling.h"
#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {

/// Points that are gathered together: as many as a ShadowPacket has rays.
inline constexpr int lane_count = 16;

using Lanes = float[lane_count];

struct alignas(64) Vec3Lanes {
    Lanes x, y, z;
    glm::vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// One colour per lane.
struct alignas(64) RgbLanes {
    Lanes r, g, b;
    glm::vec3 at(int lane) const { return {r[lane], g[lane], b[lane]}; }
};

/// Directions across an axis, so that a box can be bounded about it.
struct FrameLanes {
    Vec3Lanes axis, tangent, bitangent;
};

inline void put(Vec3Lanes& lanes, int i, glm::vec3 v) {
    lanes.x[i] = v.x;
    lanes.y[i] = v.y;
    lanes.z[i] = v.z;
}

inline void put_frame(FrameLanes& lanes, int i, glm::vec3 axis) {
    glm::vec3 t, b;
    core::make_frame(axis, t, b);
    put(lanes.axis, i, axis);
    put(lanes.tangent, i, t);
    put(lanes.bitangent, i, b);
}

RENDER2MPEG_ALWAYS_INLINED float dot(const Vec3Lanes& a, const Vec3Lanes& b, int i) {
    return a.x[i] * b.x[i] + a.y[i] * b.y[i] + a.z[i] * b.z[i];
}

}  // namespace render2mpeg::renderer
