#pragma once
// Gathers the light of groups of points: lightcuts, step by step.
#include <span>

#include "renderer/cut/cut.h"
#include "renderer/cut/cut_sums.h"
#include "renderer/cut/gathered_light.h"
#include "renderer/cut/lamp_light.h"
#include "renderer/cut/shadow_tester.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Whether a light's shadows may be interpolated between places.
enum class Shadow { sharp, smooth };

/// Gathers the light of one group of points at a time. One per task: it keeps memory between groups, no values.
class Gatherer {
  public:
    Gatherer(const LightTrees& light_trees, const RayTracer& tracer)
        : light_trees_(light_trees), tracer_(tracer), shadows_(light_trees, tracer), cut_(light_trees) {}

    /// By a cut through all trees at once that every lane's tolerance accepts [Walter2005, 4].
    void gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits, GatheredLight& out);

    /// Only lights that are not clustered, each by itself: those whose shadows are too sharp to be interpolated
    /// (punctual lights, small suns), or the other lamps that are lit by as a whole. Lamps by as many samples as
    /// `tolerance` asks for; null: by all, and all lanes are copies of one point. `shadows`: those of the sharp lights,
    /// one each in the order of LightTrees, known before and added to; empty: nobody knows or asks.
    void gather_exact(const GatherLanes& lanes, Shadow shadow, const GroupTolerance* tolerance,
                      std::span<LaneShadows> shadows, GatheredLight& out);

    /// Every light point by itself, in the order of the trees: what all cuts are held against.
    void gather_all(const GatherLanes& lanes, GatheredLight& out);

  private:
    void add_exact(const GatherLanes& lanes, std::span<LaneShadows> shadows, CutSums& sums, Lanes& luminance,
                   GatheredLight& out);
    void add_lamps(const GatherLanes& lanes, Shadow shadow, LampAccuracy accuracy, std::span<LaneShadows> shadows,
                   CutSums& sums, Lanes& luminance, Lanes& variance, GatheredLight& out);

    const LightTrees& light_trees_;
    const RayTracer& tracer_;
    ShadowTester shadows_;
    Cut cut_;
};

}  // namespace render2mpeg::renderer
