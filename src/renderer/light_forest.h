#pragma once

#include <array>
#include <span>
#include <vector>

#include "renderer/light_kernels.h"
#include "renderer/light_tree.h"

namespace render2mpeg::renderer {

/// A light that every point gathers by itself.
struct ExactLight {
    LightFamily family = LightFamily::punctual;
    TreeLight light;
};

/// All light of one instant, ready to be gathered: the direct light tree, which is one tree per family since their
/// bounds differ, the indirect tree, and the few lights that are not clustered.
struct LightForest {
    /// Direct trees by family, then the indirect one.
    static constexpr int direct_trees = 3;
    static constexpr int tree_count = direct_trees + 1;
    std::array<LightTree, tree_count> trees;
    std::vector<ExactLight> exact;
    GeometryClamp direct_clamp, indirect_clamp;
    bool translucent = false;  ///< shadow rays may meet surfaces that let light through

    static bool is_direct(int tree) { return tree < direct_trees; }
    GeometryClamp clamp(int tree) const { return is_direct(tree) ? direct_clamp : indirect_clamp; }
};

/// As many punctual lights as this, in all, are gathered exactly instead of being clustered. chosen: 16, below which a
/// cut at 2 % saves few rays, since each lamp that matters is a cluster of its own; not tuned.
inline constexpr std::size_t most_exact_lights = 16;

/// Sorts direct light points into exact lights and trees; `vpls` become the indirect tree.
LightForest plant(std::span<const LightPoint> direct, std::span<const LightPoint> vpls, std::uint64_t seed);

}  // namespace render2mpeg::renderer
