#pragma once
// Clusters light points bottom up into a tree's topology.
#include <cstdint>

#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// Two lights or pairs of which a node will hold.
using LightPair = std::array<LightRef, 2>;

/// Clusters a tree's lights, which lie in an order where near lights have near indices: pairs come before those they
/// are part of, the last is the whole. At least one light.
std::vector<LightPair> cluster(const LightTree& tree);

/// Computes all nodes and their grid from the lights as they lie and shine now; who is whose child stays.
void refit(LightTree& tree, std::uint64_t seed);

/// The cost of a tree: the sum over its inner nodes of what clustering minimises [Walter2005, 4.1],
/// intensity x (diagonal^2 + c^2 (1 - cos half angle)^2). For tests and benchmarks.
double cost_of(const LightTree& tree);

}  // namespace render2mpeg::renderer
