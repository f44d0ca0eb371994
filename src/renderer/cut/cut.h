#pragma once
// The lightcut: gathers light for a group of points within their tolerances.
#include <cstdint>
#include <vector>

#include "renderer/base/stop.h"
#include "renderer/cut/cut_outline.h"
#include "renderer/cut/cut_rule.h"
#include "renderer/cut/dynamic_objects.h"
#include "renderer/cut/point_light.h"
#include "renderer/cut/refinement_queue.h"
#include "renderer/cut/shields.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Where a shadow ray ends, as a share of the way to its light: Embree's distance to the light's own surface errs, and
/// surfaces in planes through the origin have hardly any offset of their own. chosen: 1 - 2^-18 of 1 - 2^-24 to
/// 1 - 2^-14 (docs/fits/lightcut.md).
inline constexpr float shadow_ray_end = 1.0f - 0x1p-18f;

/// Light that reaches each lane. The lobe's radiance is f0 x `f0` + `schlick`.
struct GatheredLight {
    RgbLanes direct;       ///< irradiance
    RgbLanes indirect;     ///< irradiance
    RgbLanes f0, schlick;  ///< of the GGX lobe, per unit of its two parts; unset where the group has none
    Lanes clamped;         ///< luminance that the clamp of near lights removed
    Lanes error;           ///< luminance by which the cut may err, as its stopping rule reckons; 0 without a cut
    int direct_clusters = 0, indirect_clusters = 0;
    std::uint32_t capped = 0;  ///< lanes whose tolerance was not reached within the largest cut
    std::uint64_t shadow_rays = 0;
};

class CutSums;

/// What bounds a cut from outside.
struct CutLimits {
    int least = 8;  ///< clusters of all trees together
    int most = 1000;
    Stop stop = Stop::honest;
    float error_scale = 1;  ///< multiplies what a cut is thought to err by: what fits vary
    bool exact = true;      ///< gather the lights that are not clustered as well; else their light is known, as base
};

/// Gathers the light of one group of points at a time. One per thread: it keeps memory between groups, no values.
class Gatherer {
  public:
    Gatherer(const LightTrees& light_trees, const RayTracer& tracer) : light_trees_(light_trees), tracer_(tracer) {}

    /// By a cut through all trees at once that every lane's tolerance accepts [Walter2005, 4].
    /// Where it may, it begins with the splits of a neighbour's cut through the same light trees.
    void gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits, GatheredLight& out,
                const CutOutline* begin_with = nullptr);

    /// What neighbours may begin with: the last cut that `gather` made, of these lanes, which began with nothing.
    void outline(const GatherLanes& lanes, CutOutline& out) const;

    /// Only the lights that are not clustered, each by itself.
    void gather_exact(const GatherLanes& lanes, GatheredLight& out);

    /// Every light point by itself, in the order of the trees: what all cuts are held against.
    void gather_all(const GatherLanes& lanes, GatheredLight& out);

  private:
    static constexpr std::uint32_t no_slot = 0xffffffffu, no_veil = 0xffffffffu;

    /// One cluster of the cut: what its representative sends and whom it reaches. Three cache lines: a cut of a
    /// thousand of them stays near.
    struct alignas(64) Slot {
        Slot() {}       // leaves lanes as they are
        Lanes diffuse;  ///< irradiance by unit intensity, visibility included
        Lanes bound;    ///< of its luminance if all of it were visible; 0 for a single light
        glm::vec3 intensity;
        LightRef ref;
        std::uint32_t representative = 0;
        std::uint32_t part = 0;  ///< which it is of the cut (CutOutline::Split)
        /// Bit i: lane i is lit, or not known to be in shadow: as its ray found, where none was needed as its parent.
        std::uint16_t lit = 0;
        std::uint16_t unknown = 0;  ///< bit i: nobody knows; counts as half lit
        std::uint8_t tree = 0;
        bool is_open = false;                       ///< may be split, and some lane could notice
        bool any_clamped = false;                   ///< of `unit`
        bool is_dark = false;                       ///< all rays to the representative were blocked
        bool is_tested = false;                     ///< by shields
        bool is_hidden = false;                     ///< by shields: nothing of it reaches any lane
        std::uint16_t shields = GroupShields::all;  ///< that may hide its lights
        std::uint32_t veil = no_veil;               ///< of a finished cut
    };
    /// The same slots' GGX lobes, by unit intensity; only for glossy lanes.
    struct alignas(64) SlotLobe {
        SlotLobe() {}
        Lanes f0, schlick;
    };
    /// What translucent surfaces let through; 1 where nobody knows; only where there are any.
    struct Tint {
        float passes[lane_count][3];
    };

    struct Settled {
        float priority;  ///< when last asked for
        std::uint32_t slot;
    };

    /// What a light sends to the lanes, visibility included. Before it is traced: what is known of its parent's.
    struct Arrival {
        LightLanes unit;
        std::uint16_t lit = 0, unknown = 0;  ///< as of Slot
        bool is_blocked = false;             ///< rays were traced, and none arrived
        Tint tint;                           ///< unset where nothing is translucent
    };

    void trace(const GatherLanes& lanes, LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp,
               Arrival& arrival, GatheredLight& out);
    std::uint32_t withheld(const ShadowPacket& packet, GatheredLight& out) const;
    void trace_slot(const GatherLanes& lanes, std::uint32_t slot, Arrival& arrival, GatheredLight& out);
    std::uint32_t add_slot(const GatherLanes& lanes, int tree, LightRef ref);
    inline UnitLight unit_of(std::uint32_t slot) const;
    UnitLight unit_of(const GatherLanes& lanes, const Arrival& arrival) const;
    void gather_exact(const GatherLanes& lanes, CutSums& sums, GatheredLight& out);
    void start_cut(const GatherLanes& lanes, const CutLimits& limits, const CutOutline* begin_with, GatheredLight& out);
    float in_bounds(float priority, float factor) const;
    float strictness(const GatherLanes& lanes, const Lanes& luminance) const;
    float least_priority(const GatherLanes& lanes, const CutOutline& outline) const;
    void replay(const GatherLanes& lanes, const CutOutline& outline, const CutLimits& limits, GatheredLight& out);
    void refine_classic(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out);
    void refine_honest(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out);
    /// A slot's node replaced by the child that keeps its representative; the other child is a new slot.
    struct Divided {
        std::uint32_t added;
        bool first_keeps;
    };
    Divided divide(const GatherLanes& lanes, std::uint32_t slot, GatheredLight& out);
    void split(const GatherLanes& lanes, std::uint32_t slot, float priority, GatheredLight& out);
    void push(const GatherLanes& lanes, std::uint32_t slot);
    bool reopen(const GatherLanes& lanes);
    void add_square(std::uint32_t slot, double sign);
    void sum_afresh(const GatherLanes& lanes);
    bool is_safe(const GatherLanes& lanes);
    bool seems_safe(float safe_priority);
    void sum_luminance(const GatherLanes& lanes);
    /// The clusters two levels below one: what its geometry is summed over.
    struct Parts {
        std::uint32_t light[4];  ///< their representatives
        glm::vec3 intensity[4];
        int count = 0;
    };
    Parts parts_of(const GatherLanes& lanes, const Slot& slot) const;
    void sum_finely(const GatherLanes& lanes, std::uint32_t slot, const Parts& parts, CutSums& sums) const;
    void sum_slots(const GatherLanes& lanes, bool finely, CutSums& sums, GatheredLight& out);
    void fetch_split(std::uint32_t slot) const;
    void fetch_light(const GatherLanes& lanes, std::uint32_t slot) const;
    bool hide(const GatherLanes& lanes, std::uint32_t slot);
    void veil(const GatherLanes& lanes, std::uint32_t slot, GatheredLight& out);
    void look_behind_movers(const GatherLanes& lanes, GatheredLight& out);
    /// Of a slot that something moves before: the lanes in which each of its parts is seen.
    struct Veil {
        std::uint16_t lit[4];
    };

    const LightTrees& light_trees_;
    const RayTracer& tracer_;
    CutRule rule_;
    GroupShields shields_;
    GroupDynamicObjects dynamic_objects_;
    alignas(64) Lanes luminance_{}, exact_luminance_{};
    alignas(64) Lanes peak_{};                  ///< largest luminance since it was last summed afresh
    alignas(64) double squares_[lane_count]{};  ///< honest: sums of the squared bounds of all slots
    std::uint32_t witness_ = no_slot;           ///< honest: what kept the cut from being safe, when last looked at
    alignas(64) Lanes largest_{};               ///< honest: their largest bounds, as of the last fresh sum
    std::vector<Slot> slots_;
    std::vector<SlotLobe> lobes_;
    std::vector<Tint> tints_;
    RefinementQueue queue_;
    std::vector<Settled> settled_;            ///< classic: what is fine enough, as far as is known
    std::vector<CutOutline::Split> history_;  ///< of the cut, where it began with nothing
    std::uint32_t root_slot_[LightTrees::tree_count]{};
    std::vector<Veil> veils_;             ///< of the slots that have one
    std::vector<std::uint32_t> slot_of_;  ///< of each part, while a cut is replayed
    std::size_t least_ = 0;               ///< clusters of a cut
};

}  // namespace render2mpeg::renderer
