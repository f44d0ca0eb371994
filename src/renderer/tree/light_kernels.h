#pragma once
// A cluster's light and its bound at sixteen points: the innermost loops.
#include <span>

#include "renderer/base/isa_clones.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"

/// One light or one node against sixteen points at once: the renderer's innermost loops.
namespace render2mpeg::renderer {

/// The clamp of near light points (docs/model/clamping.md): one counts as a disc of squared radius disc2 / `scale`.
/// G is at most 1 over that, and GGX lobes are widened by what the disc spans, so that sharp ones do not show single
/// points.
struct GeometryClamp {
    float scale = 0.02f;
    /// What of these lights lobes see by rays that have them (Bsdf::has_narrow_lobe): the more the larger a light's
    /// disc is seen (`lobe::by_trees`), or all.
    enum class ByRays { none, by_size, all } by_rays = ByRays::none;
    /// No clamp at all: beyond any G that occurs, yet finite, so that 0 times it is 0.
    static GeometryClamp none() { return {1e30f, ByRays::none}; }
};

/// Unoccluded contribution of unit intensity of `light` to the lanes. `spot`: of punctual lights, LightTree::spot.
void evaluate_light(const GatherLanes& lanes, LightType type, const TreeLight& light, const Spot* spot,
                    GeometryClamp clamp, LightLanes& out);

/// Sixteen lights as arrays. `fill_lights` repeats the last where there are fewer, with no intensity.
struct alignas(64) LightPacket {
    Vec3Lanes position, normal, intensity;
    Lanes disc2, spot_scale, spot_offset, spot_smooth;
};
/// `count` lights of a tree from `first` on.
void fill_lights(LightPacket& packet, const LightTree& tree, std::size_t first, std::size_t count);

/// The same for a light of its own in every lane.
void evaluate_lights(const GatherLanes& lanes, LightType type, const LightPacket& lights, GeometryClamp clamp,
                     LightLanes& out);

/// A light that shines with another intensity than its own: that of all lights it stands for.
struct Representative {
    const TreeLight* light;
    const Spot* spot;  ///< see evaluate_light
    glm::vec3 intensity;
};

/// Adds the irradiance that some lights send to the lanes together, without visibility; for lanes without a lobe.
void add_irradiance(const GatherLanes& lanes, LightType type, const Representative* lights, int count,
                    GeometryClamp clamp, RgbLanes& out);

/// An upper bound, for each lane, of the luminance that the lights below a node of `tree` can add to its pixel, all of
/// them visible.
void bound_node(const GatherLanes& lanes, const LightTree& tree, std::uint32_t node, GeometryClamp clamp, Lanes& out);

/// Contribution of a light of unit intensity to each lane, visibility included, wherever it is kept.
struct UnitLight {
    const Lanes& diffuse;
    const Lanes* f0;  ///< null, as `schlick`, where no lane is glossy
    const Lanes* schlick;
    const float (
        *passes)[3];  ///< of each lane, transmittance of translucent surfaces; null where nothing is translucent
};

RENDER2MPEG_ALWAYS_INLINED UnitLight unit_light(const GatherLanes& lanes, const LightLanes& unit) {
    return {unit.diffuse, lanes.glossy ? &unit.f0 : nullptr, lanes.glossy ? &unit.schlick : nullptr, nullptr};
}

/// Adds the luminance that a light of this intensity gives each lane's pixel.
RENDER2MPEG_ALWAYS_INLINED void add_luminance(const GatherLanes& __restrict lanes, const UnitLight& unit,
                                              const glm::vec3& intensity, Lanes& __restrict luminance) {
    const float red = intensity.x, green = intensity.y, blue = intensity.z;
    const auto& [wx, wy, wz] = lanes.diffuse_weight;
    if (unit.passes == nullptr) {
        for (int i = 0; i < lane_count; ++i)
            luminance[i] += unit.diffuse[i] * (wx[i] * red + wy[i] * green + wz[i] * blue);
    } else {
        for (int i = 0; i < lane_count; ++i)
            luminance[i] += unit.diffuse[i] * (wx[i] * red * unit.passes[i][0] + wy[i] * green * unit.passes[i][1] +
                                               wz[i] * blue * unit.passes[i][2]);
    }
    if (unit.f0 == nullptr) return;
    const Lanes &f0 = *unit.f0, &schlick = *unit.schlick;
    const auto& [fx, fy, fz] = lanes.f0_weight;
    const auto& [sx, sy, sz] = lanes.schlick_weight;
    for (int i = 0; i < lane_count; ++i) {
        const float r = unit.passes == nullptr ? red : red * unit.passes[i][0];
        const float g = unit.passes == nullptr ? green : green * unit.passes[i][1];
        const float b = unit.passes == nullptr ? blue : blue * unit.passes[i][2];
        luminance[i] += f0[i] * (fx[i] * r + fy[i] * g + fz[i] * b) + schlick[i] * (sx[i] * r + sy[i] * g + sz[i] * b);
    }
}

}  // namespace render2mpeg::renderer
