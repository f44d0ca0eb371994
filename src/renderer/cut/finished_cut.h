#pragma once
// Sums what the clusters of a finished cut send.
#include "renderer/cut/clusters.h"
#include "renderer/cut/cut_sums.h"

namespace render2mpeg::renderer {

/// Adds what the clusters of a finished cut send to the lanes. The geometry of each is summed over four lights of it,
/// its parts two levels below, with the visibility of its one representative: geometry needs no rays
/// (docs/model/lightcut.md). Counts clusters in `out`.
void sum_clusters(const LightTrees& light_trees, const GatherLanes& lanes, const Clusters& clusters, CutSums& sums,
                  GatheredLight& out);

}  // namespace render2mpeg::renderer
