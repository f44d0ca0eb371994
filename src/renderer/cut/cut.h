#pragma once
// The lightcut: gathers light for a group of points within their tolerances.
#include <cstdint>
#include <limits>

#include "renderer/cut/clusters.h"
#include "renderer/cut/gathered_light.h"
#include "renderer/cut/refinement_queue.h"
#include "renderer/cut/shadow_tester.h"
#include "renderer/cut/stopping_rule.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// External limits of a cut.
struct CutLimits {
    int least = 8;  ///< clusters of all trees together
    int most = 1000;
    float error_scale = 1;  ///< multiplies the estimated error of a cut (calibration/)
    bool exact = true;      ///< gather the lights that are not clustered as well; else their light is known, as base
};

/// The cut through all light trees at once for one group of points, while it is refined [Walter2005, 4].
class Cut {
  public:
    explicit Cut(const LightTrees& light_trees) : light_trees_(light_trees) {}

    /// Starts with the roots of the trees. `exact_luminance`: of the lights that are not clustered, for each lane.
    /// `lanes` and `shadows`, which is started for them, outlive the refinement.
    void start(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
               const Lanes& exact_luminance, ShadowTester& shadows);

    /// Whether some cluster may be split.
    bool can_refine() const { return !queue_.empty() && clusters_.size() < most_; }

    /// Whether every lane's estimated error is below its tolerance. Conservative: looking at all clusters takes as
    /// long as some splits, and is done only where the answer may be yes.
    bool is_fine_enough();

    /// Splits the cluster of the highest priority, and traces shadow rays to the new one's representative.
    void refine();

    /// Writes every lane's estimated error, and which lanes' tolerance is broken, to `out`.
    void estimate_errors(GatheredLight& out);

    const Clusters& clusters() const { return clusters_; }

  private:
    static constexpr std::uint32_t no_cluster = std::numeric_limits<std::uint32_t>::max();

    void trace(std::uint32_t index, LightContribution& contribution);
    void bound_and_queue(std::uint32_t index);
    std::uint32_t split(std::uint32_t index);
    void add_square(std::uint32_t index, double sign);
    void sum_luminance();
    void sum_afresh();
    bool seems_safe();
    bool is_safe();

    const LightTrees& light_trees_;
    ShadowTester* shadows_ = nullptr;
    const GatherLanes* lanes_ = nullptr;
    StoppingRule rule_;
    Clusters clusters_;
    RefinementQueue queue_;
    std::size_t most_ = 0;                 ///< clusters
    std::size_t next_look_ = 0;            ///< fewer clusters are not looked at as a whole
    bool summed_ = false;                  ///< `sum_of_squares_` is kept
    bool accepted_ = false;                ///< by the stopping rule
    std::uint32_t limiting_ = no_cluster;  ///< cluster that kept the cut from being safe, when last looked at
    alignas(64) Lanes exact_luminance_{}, luminance_{};
    alignas(64) double sum_of_squares_[lane_count]{};  ///< of the bounds of all clusters
    alignas(64) Lanes largest_{};                      ///< their largest bounds, as of the last fresh sum
};

}  // namespace render2mpeg::renderer
