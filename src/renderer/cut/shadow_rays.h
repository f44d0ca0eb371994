#pragma once
// Aims and traces packets of shadow rays.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "renderer/base/air.h"
#include "renderer/base/isa_clones.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// Where a shadow ray ends, as a share of the way to its light: Embree's distance to the light's own surface errs, and
/// surfaces in planes through the origin have hardly any offset of their own. chosen: 1 - 2^-18; at 1 five of six
/// pixels of the Cornell box err by more than 2 % (grains of false shadow), at 1 - 2^-24 still many, from 1 - 2^-22 to
/// 1 - 2^-14 no pixel changes.
inline constexpr float shadow_ray_end = 1.0f - 0x1p-18f;

/// Whose places `aim` gets: one light for all lanes, or one for each.
enum class Aimed { at_one, at_each };

/// Points a packet's rays from the lanes' origins towards lights at (x, y, z), or, directional ones, along these unit
/// directions. Which of them are asked for is left to the caller.
template <Aimed aimed>
RENDER2MPEG_ALWAYS_INLINED void aim(const Vec3Lanes& __restrict origin, LightType type, const float* x, const float* y,
                                    const float* z, ShadowPacket& __restrict packet) {
    constexpr int step = aimed == Aimed::at_each ? 1 : 0;
    const bool far_away = type == LightType::directional;
    const float keep = far_away ? 0.0f : 1.0f;
    const float far = far_away ? std::numeric_limits<float>::infinity() : shadow_ray_end;
    for (int i = 0; i < lane_count; ++i) {
        packet.origin_x[i] = origin.x[i];
        packet.origin_y[i] = origin.y[i];
        packet.origin_z[i] = origin.z[i];
        packet.direction_x[i] = x[step * i] - keep * origin.x[i];
        packet.direction_y[i] = y[step * i] - keep * origin.y[i];
        packet.direction_z[i] = z[step * i] - keep * origin.z[i];
        packet.far[i] = far;
    }
}

/// Multiplies what passes of the light of these rays by what the air lets through.
inline void dim(const Air& air, const ShadowPacket& packet, std::uint32_t rays, glm::vec3* passes) {
    for (int i = 0; i < lane_count; ++i) {
        if ((rays >> i & 1u) == 0) continue;
        const glm::vec3 origin{packet.origin_x[i], packet.origin_y[i], packet.origin_z[i]},
            way{packet.direction_x[i], packet.direction_y[i], packet.direction_z[i]};
        const float length = std::sqrt(glm::dot(way, way));
        if (!(length > 0.0f)) continue;
        const glm::vec3 direction = way / length;
        passes[i] *= air.left_of_light(origin, direction, std::isinf(packet.far[i]) ? packet.far[i] : length);
    }
}

/// Shutter times of a packet's rays.
struct ShadowTimes {
    Lanes at;

    /// Of a lane's ray at a place of its own among so many.
    void set(const GatherLanes& lanes, int lane, int place, int places) {
        const float part = lanes.shadow_part[lane];
        at[lane] = part < 0.0f ? scene::middle_time
                               : (static_cast<float>(place) + part) / static_cast<float>(std::max(places, 1));
    }
    /// Of its only ray to a light: another part for each light, so that many lights see all of the time.
    void set_for(const GatherLanes& lanes, int lane, float x, float y, float z) {
        const std::uint32_t bits =
            (std::bit_cast<std::uint32_t>(x) * 0x9e3779b1u ^ std::bit_cast<std::uint32_t>(y)) * 0x85ebca6bu ^
            std::bit_cast<std::uint32_t>(z) * 0xc2b2ae35u;
        at[lane] = turned(lanes, lane, static_cast<float>(bits >> 8) * 0x1p-24f);
    }
    /// Of a lane's k-th ray, where the first of them are as even in time as all are.
    static float kth(const GatherLanes& lanes, int lane, std::size_t k) {
        return turned(lanes, lane, static_cast<float>(std::fmod(0.6180339887498949 * static_cast<double>(k), 1.0)));
    }

  private:
    static float turned(const GatherLanes& lanes, int lane, float by) {
        const float part = lanes.shadow_part[lane], sum = part + by;
        return part < 0.0f ? scene::middle_time : sum - std::floor(sum);
    }
};

/// The same, of a light.
RENDER2MPEG_ALWAYS_INLINED void aim(const GatherLanes& lanes, LightType type, const TreeLight& light,
                                    ShadowPacket& packet) {
    aim<Aimed::at_one>(lanes.origin, type, &light.position.x, &light.position.y, &light.position.z, packet);
}

}  // namespace render2mpeg::renderer
