#pragma once
// Shadow rays from a group of points.
#include <cstdint>

#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Transmittance of translucent surfaces to each lane, per channel; 1 where nobody knows.
struct LayerTint {
    float passes[lane_count][3];
};

/// Contribution of a light to the lanes, visibility included. Before it is traced: as known of its parent's.
struct LightContribution {
    LightLanes unit;
    std::uint16_t lit = 0, unknown = 0;  ///< as of Cluster
    LayerTint tint;                      ///< unset where nothing is translucent

    /// Of a light of which nothing is known: lit or not, and unknown, in all lanes or in none.
    static LightContribution unknown_in(std::uint16_t lanes);

    /// `unit`, with the transmittance of layers.
    UnitLight visible(const GatherLanes& lanes, bool translucent) const {
        UnitLight light = unit_light(lanes, unit);
        if (translucent) light.passes = tint.passes;
        return light;
    }
};

/// Lanes of which it is known that a light reaches them whole, or not at all.
struct LaneShadows {
    std::uint16_t lit = 0, dark = 0;

    std::uint32_t known() const { return static_cast<std::uint32_t>(lit | dark); }
    void set(int lane, bool is_lit) { (is_lit ? lit : dark) |= static_cast<std::uint16_t>(1u << lane); }
};

/// Tests which lights reach one group of points, by rays.
class ShadowTester {
  public:
    ShadowTester(const LightTrees& light_trees, const RayTracer& tracer) : light_trees_(light_trees), tracer_(tracer) {}

    /// For these lanes, which outlive it; no rays were traced.
    void start(const GatherLanes& lanes);

    /// Evaluates a light with the visibility of one shadow ray from each lane that it could reach. `on_mover`: it lies
    /// on what moves, which would throw its shadow on it at other times than the shutter's middle.
    void trace(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp, Bodies bodies,
               LightContribution& contribution, bool on_mover = false);

    /// The same of a direct light that is gathered by itself: `unit` times the share of each lane's places that it
    /// reaches. `lit` and `unknown` say nothing then. Further places are asked 16 at a time. `shadows`, unless null:
    /// lanes that trace no ray, to which others are added that are found lit or dark.
    void trace_from_places(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp,
                           LaneShadows* shadows, LightContribution& contribution);

    std::uint64_t rays() const { return rays_; }
    Bodies bodies() const { return light_trees_.bodies; }

    /// Bit i: ray i of the packet carries no light of these trees. `passes`, of sixteen, where something is
    /// translucent: transmittance of the others.
    std::uint32_t blocked(const ShadowPacket& packet, glm::vec3* passes = nullptr);

  private:
    struct PlaceCounts;
    void trace_further(LightType type, const TreeLight& light, const std::vector<glm::vec3>& places, int lane,
                       PlaceCounts& counts);
    void trace_place(ShadowPacket& packet, int place, PlaceCounts& counts);
    std::uint32_t swept(const ShadowPacket& packet, std::uint32_t active) const;
    std::uint32_t reach(const ShadowPacket& packet, glm::vec3* passes);
    /// Whether the transmittance of air is so cheap that rays get it which nobody asks for.
    bool knows_all() const { return light_trees_.air != nullptr && light_trees_.air->volumes().empty(); }
    void count(std::uint32_t active) { rays_ += static_cast<std::uint64_t>(__builtin_popcount(active)); }

    const LightTrees& light_trees_;
    const RayTracer& tracer_;
    const GatherLanes* lanes_ = nullptr;
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
