#pragma once
// A light point: place, direction, intensity and kind.
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/numeric.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// How a light point's radiant intensity depends on direction.
enum class LightPointKind : std::uint8_t {
    oriented,    ///< emissive triangle or VPL: intensity x max(0, cos to its normal)
    omni,        ///< point light
    spot,        ///< punctual spot
    directional  ///< infinitely far: `intensity` is irradiance across the beam, `normal` the direction it shines along
};

/// One light point. Lit point x receives intensity x emit(direction) / distance^2 (docs/model/lights.md).
struct LightPoint {
    glm::vec3 position{0};
    glm::vec3 normal{0, 0, 1};              ///< unit
    glm::vec3 intensity{0};                 ///< radiant intensity along the normal, per channel, finite, >= 0
    float spot_scale = 0, spot_offset = 0;  ///< spot: see spot_falloff
    float spot_smooth = 0;                  ///< likewise
    float range = 0;                        ///< punctual lights' range, 0: infinite
    /// Squared radius of the disc of surface that the point stands for (directional: solid angle over pi); 0: a true
    /// point. Light nearer than a multiple of it is clamped, and sharp lobes see the disc, not the point.
    float disc2 = 0;
    std::uint32_t id = 0;                ///< stable over the film; photons' own VPLs have none
    std::uint32_t object = 0xffffffffu;  ///< on whose surface it lies; no_id: on none, or an anchor that never moves
    LightPointKind kind = LightPointKind::oriented;
};

/// Radiant intensity of a spot over that along its axis: s^2 with s = clamp(cos scale + offset, 0, 1)
/// [KHR_lights_punctual]; where `smooth` is 1, as Cycles has it before Blender 4, cos s^2 (3 - 2 s).
inline float spot_falloff(float cosine, float scale, float offset, float smooth) {
    const float s = std::clamp(cosine * scale + offset, 0.0f, 1.0f);
    return s * s * (1.0f + smooth * (cosine * (3.0f - 2.0f * s) - 1.0f));
}

/// The same of a lamp, 1 of one that is no spot, towards `from_light` (unit).
inline float spot_share(const scene::LightState& lamp, glm::vec3 from_light) {
    if (lamp.kind != scene::LightKind::spot) return 1.0f;
    const float scale = 1.0f / std::max(lamp.cos_inner - lamp.cos_outer, 1e-3f);
    return spot_falloff(glm::dot(from_light, lamp.direction), scale, -lamp.cos_outer * scale,
                        lamp.smooth_cosine ? 1.0f : 0.0f);
}

inline bool is_finite(const LightPoint& p) {
    return core::is_finite(p.intensity) && core::is_finite(p.position) && core::is_finite(p.normal);
}

}  // namespace render2mpeg::renderer
