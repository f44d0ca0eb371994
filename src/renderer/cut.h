#pragma once

#include <cstdint>
#include <vector>

#include "renderer/cut_rule.h"
#include "renderer/light_forest.h"
#include "renderer/point_light.h"
#include "renderer/ray_tracer.h"
#include "renderer/shields.h"
#include "renderer/stop.h"

namespace render2mpeg::renderer {

/// One colour per lane.
struct alignas(64) RgbLanes {
    Lanes r, g, b;
    glm::vec3 at(int lane) const { return {r[lane], g[lane], b[lane]}; }
};

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
    float caution = 1;  ///< multiplies what a cut is thought to err by: what fits vary
    bool exact = true;  ///< gather the lights that are not clustered as well; else their light is known, as base
};

/// Tolerances of a group's lanes, in luminance of their pixels; see CutRule.
struct alignas(64) GroupTolerance {
    Lanes absolute, relative, base;
    void set(int lane, const PointTolerance& t) {
        absolute[lane] = t.absolute;
        relative[lane] = t.relative;
        base[lane] = t.base;
    }
};

/// Gathers the light of one group of points at a time. One per thread: it keeps memory between groups, no values.
class Gatherer {
  public:
    Gatherer(const LightForest& forest, const RayTracer& tracer) : forest_(forest), tracer_(tracer) {}

    /// By a cut through all trees at once that every lane's tolerance accepts [Walter2005, 4].
    void gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits, GatheredLight& out);

    /// Only the lights that are not clustered, each by itself.
    void gather_exact(const GatherLanes& lanes, GatheredLight& out);

    /// Every light point by itself, in the order of the trees: what all cuts are held against.
    void gather_all(const GatherLanes& lanes, GatheredLight& out);

  private:
    /// One cluster of the cut: what its representative sends and whom it reaches. Three cache lines: a cut of a
    /// thousand of them stays near.
    struct alignas(64) Slot {
        Slot() {}       // leaves lanes as they are
        Lanes diffuse;  ///< irradiance by unit intensity, visibility included
        Lanes bound;    ///< of its luminance if all of it were visible; 0 for a single light
        glm::vec3 intensity;
        LightRef ref;
        std::uint32_t representative = 0;
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
    struct Entry {
        float urgency;
        std::uint32_t slot;
    };
    struct LessUrgent {
        bool operator()(const Entry& a, const Entry& b) const { return a.urgency < b.urgency; }
    };

    /// What a light sends to the lanes, visibility included. Before it is traced: what is known of its parent's.
    struct Arrival {
        LightLanes unit;
        std::uint16_t lit = 0, unknown = 0;  ///< as of Slot
        bool is_blocked = false;             ///< rays were traced, and none arrived
        Tint tint;                           ///< unset where nothing is translucent
    };

    void trace(const GatherLanes& lanes, LightFamily family, const TreeLight& light, GeometryClamp clamp,
               Arrival& arrival, GatheredLight& out);
    void trace_slot(const GatherLanes& lanes, std::uint32_t slot, Arrival& arrival, GatheredLight& out);
    std::uint32_t add_slot(const GatherLanes& lanes, int tree, LightRef ref);
    inline UnitLight unit_of(std::uint32_t slot) const;
    UnitLight unit_of(const GatherLanes& lanes, const Arrival& arrival) const;
    void gather_exact(const GatherLanes& lanes, CutSums& sums, GatheredLight& out);
    void start_cut(const GatherLanes& lanes, GatheredLight& out);
    void refine_classic(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out);
    void refine_honest(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out);
    void split(const GatherLanes& lanes, std::uint32_t slot, GatheredLight& out);
    void push(const GatherLanes& lanes, std::uint32_t slot);
    bool reopen(const GatherLanes& lanes);
    std::uint32_t pop();
    void add_square(std::uint32_t slot, double sign);
    void sum_afresh(const GatherLanes& lanes);
    bool is_safe(const GatherLanes& lanes);
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
    void fetch_next() const;
    bool hide(const GatherLanes& lanes, std::uint32_t slot);

    const LightForest& forest_;
    const RayTracer& tracer_;
    CutRule rule_;
    GroupShields shields_;
    alignas(64) Lanes luminance_{}, exact_luminance_{};
    alignas(64) double squares_[lane_count]{};  ///< honest: sums of the squared bounds of all slots
    alignas(64) Lanes largest_{};               ///< honest: their largest bounds, as of the last fresh sum
    std::vector<Slot> slots_;
    std::vector<SlotLobe> lobes_;
    std::vector<Tint> tints_;
    std::vector<Entry> heap_, settled_;
};

}  // namespace render2mpeg::renderer
