#pragma once

#include <cstdint>
#include <vector>

#include "renderer/cut_rule.h"
#include "renderer/light_forest.h"
#include "renderer/ray_tracer.h"
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
};

/// Tolerances of a group's lanes, in luminance of their pixels; see CutRule.
struct alignas(64) GroupTolerance {
    Lanes absolute, relative, base;
};

/// Gathers the light of one group of points at a time. One per thread: it keeps memory between groups, no values.
class Gatherer {
  public:
    Gatherer(const LightForest& forest, const RayTracer& tracer) : forest_(forest), tracer_(tracer) {}

    /// By a cut through all trees at once that every lane's tolerance accepts [Walter2005, 4].
    void gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits, GatheredLight& out);

    /// Every light point by itself, in the order of the trees: what all cuts are held against.
    void gather_all(const GatherLanes& lanes, GatheredLight& out);

  private:
    /// One cluster of the cut: what its representative sends and whom it reaches.
    struct alignas(64) Slot {
        Slot() {}         // leaves lanes as they are
        LightLanes unit;  ///< visibility included
        Lanes bound;      ///< of its luminance if all of it were visible; 0 for a single light
        Lanes visible;    ///< 0 or 1 as its rays found; where none was needed, as its parent; 0.5 where nobody knows
        LightRef ref;
        int tree = 0;
        std::uint32_t representative = 0;
        bool is_open = false;         ///< may be split, and some lane could notice
        bool reaches_any = false;     ///< some lane is not known to lie in its shadow
        float passes[lane_count][3];  ///< what translucent surfaces let through, as `visible`; 1 where nobody knows
    };
    struct Entry {
        float urgency;
        std::uint32_t slot;
    };
    static bool less_urgent(const Entry& a, const Entry& b) { return a.urgency < b.urgency; }

    void trace(const GatherLanes& lanes, LightFamily family, const TreeLight& light, Slot& slot, GatheredLight& out);
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
    void sum_finely(const GatherLanes& lanes, const Slot& slot, CutSums& sums) const;
    void add_slot(const GatherLanes& lanes, const Slot& slot, glm::vec3 intensity, Lanes& luminance) const;

    const LightForest& forest_;
    const RayTracer& tracer_;
    CutRule rule_;
    alignas(64) Lanes luminance_{}, exact_luminance_{};
    alignas(64) double squares_[lane_count]{};  ///< honest: sums of the squared bounds of all slots
    alignas(64) Lanes largest_{};               ///< honest: their largest bounds, as of the last fresh sum
    std::vector<Slot> slots_;
    std::vector<Entry> heap_, settled_;
};

}  // namespace render2mpeg::renderer
