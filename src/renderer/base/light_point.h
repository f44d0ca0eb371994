#pragma once
// A light point: the light tree's view of anything that shines.
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/color.h"
#include "core/numeric.h"
#include "core/surface_address.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// How a light point's radiant intensity depends on direction: each has a tree, since bounds differ [Walter2005, 4.1].
enum class LightType : std::uint8_t {
    oriented,    ///< a piece of a surface that shines, or a VPL: intensity x max(0, cos to its normal)
    punctual,    ///< a point, perhaps with a cone
    directional  ///< infinitely far: `intensity` is irradiance across the beam, `normal` the direction it shines along
};

/// Cone of a spot; as it stands, none.
struct Spot {
    float scale = 0, offset = 1, smooth = 0;

    /// Radiant intensity over that along the axis: s^2 with s = clamp(cos scale + offset, 0, 1) [KHR_lights_punctual];
    /// where `smooth` is 1, as Cycles has it before Blender 4, cos s^2 (3 - 2 s).
    float falloff(float cosine) const {
        const float s = std::clamp(cosine * scale + offset, 0.0f, 1.0f);
        return s * s * (1.0f + smooth * (cosine * (3.0f - 2.0f * s) - 1.0f));
    }
    /// Cosine of half the angle in which it shines.
    float outer_cosine() const { return std::clamp(core::divide_or(-offset, scale, -1.0f), -1.0f, 1.0f); }
};

inline Spot spot_of(const scene::LightState& lamp) {
    if (lamp.kind != scene::LightKind::spot) return {};
    const float scale = 1.0f / std::max(lamp.cos_inner - lamp.cos_outer, 1e-3f);
    return {scale, -lamp.cos_outer * scale, lamp.smooth_cosine ? 1.0f : 0.0f};
}

/// First ids of the sky's direct light points, and of those of lamps without a surface; below are surfaces'.
inline constexpr std::uint32_t first_sky_id = 1u << 26, first_lamp_id = 1u << 27;
/// Of them, of the flames of volumes.
inline constexpr std::uint32_t first_flame_id = 1u << 30;

/// One light point. Lit point x receives intensity x emit(direction) / distance^2 (docs/model/lights.md).
struct LightPoint {
    glm::vec3 position{0};
    glm::vec3 normal{0, 0, 1};  ///< unit
    glm::vec3 intensity{0};     ///< radiant intensity along the normal, per channel, finite, >= 0
    Spot spot;
    float range = 0;  ///< punctual lights' range, 0: infinite
    /// Squared radius of the disc of surface that the point stands for (directional: solid angle over pi); 0: a true
    /// point. Light nearer than a multiple of it is clamped, and sharp lobes see the disc, not the point.
    float disc2 = 0;
    std::uint32_t id = 0;                ///< stable over the film; of VPLs, while their path leaves as many
    std::uint32_t object = core::no_id;  ///< on whose surface it lies; no_id: on none
    LightType type = LightType::oriented;

    bool shines() const { return core::is_finite(intensity) && core::luminance(intensity) > 0.0f; }
    bool is_far() const { return type == LightType::directional; }
    bool is_of_surface() const { return type == LightType::oriented; }
    /// Of points of direct light:
    bool is_of_sky() const { return id >= first_sky_id && id < first_lamp_id; }
    bool is_of_lamp() const { return id >= first_lamp_id; }
    bool is_of_flame() const { return id >= first_flame_id; }
    /// Radiant intensity in a direction (unit) over that along the normal, as it is so far off.
    float emitted(glm::vec3 direction, float distance2) const {
        const float cosine = glm::dot(normal, direction);
        if (type != LightType::punctual) return is_far() ? 1.0f : std::max(cosine, 0.0f);
        const float reach = range > 0.0f ? distance2 / (range * range) : 0.0f;
        return std::clamp(1.0f - reach * reach, 0.0f, 1.0f) * spot.falloff(cosine);
    }
};

inline bool is_finite(const LightPoint& p) {
    return core::is_finite(p.intensity) && core::is_finite(p.position) && core::is_finite(p.normal);
}

}  // namespace render2mpeg::renderer
