#pragma once
// The light trees of a film: built once a chunk, refitted in every frame.
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "renderer/base/air.h"
#include "renderer/base/area_lamp.h"
#include "renderer/base/bodies.h"
#include "renderer/tree/light_kernels.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// A light that every point gathers by itself.
struct ExactLight {
    LightType type = LightType::punctual;
    TreeLight light;
    Spot spot;  ///< see LightTree::spot
};

/// All light of one instant, ready to be gathered: the direct light tree, which is one tree per type since their
/// bounds differ, the indirect trees of still and of moving surfaces, and the few lights that are not clustered.
struct LightTrees {
    /// Direct trees by type, then the indirect ones.
    static constexpr int direct_trees = 3;
    static constexpr int static_tree = direct_trees, dynamic_tree = direct_trees + 1;
    static constexpr int tree_count = direct_trees + 2;
    std::array<LightTree, tree_count> trees;
    std::vector<ExactLight> exact;
    std::vector<std::shared_ptr<const AreaLamp>> lamps;  ///< not in the trees either
    GeometryClamp point_clamp;                           ///< of any light point
    bool lobe_rays = false;        ///< the sky, shining surfaces and indirect light are seen by the rays of lobes
    const Air* air = nullptr;      ///< dims light on its way; null: nothing does. With it `translucent` is set
    bool translucent = false;      ///< shadow rays may meet surfaces that let light through
    Bodies bodies = Bodies::pass;  ///< to shadow rays of direct light

    /// Whether some light is gathered for every point by itself, not interpolated.
    bool has_exact() const { return sharp_lights() > 0; }
    bool has_sharp_lamps() const { return sharp_lights() > exact.size(); }
    std::size_t sharp_lights() const {
        return exact.size() + static_cast<std::size_t>(
                                  std::count_if(lamps.begin(), lamps.end(), [](const auto& l) { return l->sharp; }));
    }

    static bool is_direct(int tree) { return tree < direct_trees; }
    Bodies bodies_before(int tree) const { return is_direct(tree) ? bodies : Bodies::pass; }
    /// Lights of a size are the sky's and of shining surfaces: suns with one are area lamps.
    GeometryClamp clamp(int tree) const {
        GeometryClamp clamp = point_clamp;
        using ByRays = GeometryClamp::ByRays;
        if (lobe_rays) clamp.by_rays = is_direct(tree) ? ByRays::by_size : ByRays::all;
        return clamp;
    }
};

/// As many punctual lights as this, in all, are gathered exactly instead of being clustered. chosen: 16, below which a
/// cut at 2 % saves few rays, since each lamp that matters is a cluster of its own; not tuned.
inline constexpr std::size_t most_exact_lights = 16;

/// Light trees that follow their lights from instant to instant: who is whose neighbour in its trees was settled once,
/// from lights at their time-averaged strength, so that what changes smoothly is gathered smoothly
/// (docs/model/lights.md).
class PersistentLightTrees {
  public:
    PersistentLightTrees() = default;
    /// `average` holds every light point that will ever shine, as bright as it is in the mean.
    PersistentLightTrees(std::span<const LightPoint> average, std::uint64_t seed);

    /// The light trees of an instant: a function of these lights, and of the topologies alone. Where `may_rebuild`
    /// says so, a tree whose topology fits these lights badly is rebuilt by them first, for this instant and all later
    /// ones: to be said at instants that only the chunk decides, among them its first.
    LightTrees at(std::span<const LightPoint> now, bool may_rebuild = false);

    /// Bytes held between instants.
    std::size_t bytes() const;

  private:
    std::array<TreeTopology, LightTrees::direct_trees> topologies_;
    std::vector<std::uint32_t> exact_;  ///< ids, in order
    std::uint64_t seed_ = 0;
};

}  // namespace render2mpeg::renderer
