#pragma once

#include <cstdint>

#include "renderer/light_tree.h"

namespace render2mpeg::renderer {

/// Clusters `tree.lights`, which lie in an order where near lights have near indices, into `tree.nodes` and sets
/// `tree.root`. Children come before their parents. At least one light.
void cluster(LightTree& tree, std::uint64_t seed);

/// Computes all nodes anew from lights that have moved or shine otherwise; who is whose child stays. Parents come
/// before their children, as in a finished tree. Lights that have not changed give the same bits as `cluster` did.
void refit(LightTree& tree, std::uint64_t seed);

/// The cost of a tree: the sum over its inner nodes of what clustering minimises [Walter2005, 4.1],
/// intensity x (diagonal^2 + c^2 (1 - cos half angle)^2). For tests and benchmarks.
double cost_of(const LightTree& tree);

}  // namespace render2mpeg::renderer
