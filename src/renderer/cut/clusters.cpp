#include "renderer/cut/clusters.h"

#include <algorithm>

namespace render2mpeg::renderer {

void Clusters::start(const GatherLanes& lanes, const LightTrees& light_trees) {
    glossy_ = lanes.glossy;
    translucent_ = light_trees.translucent;
    clusters_.clear();
    lobes_.clear();
    tints_.clear();
}

std::uint32_t Clusters::add(int tree, LightRef ref) {
    const auto index = static_cast<std::uint32_t>(clusters_.size());
    Cluster& cluster = clusters_.emplace_back();
    cluster.tree = static_cast<std::uint8_t>(tree);
    cluster.ref = ref;
    if (glossy_) lobes_.emplace_back();
    if (translucent_) tints_.emplace_back();
    return index;
}

LightContribution Clusters::inherited(std::uint32_t index) const {
    LightContribution contribution;
    contribution.lit = clusters_[index].lit;
    contribution.unknown = clusters_[index].unknown;
    if (translucent_) contribution.tint = tints_[index];
    return contribution;
}

void Clusters::set(std::uint32_t index, const LightContribution& contribution) {
    Cluster& cluster = clusters_[index];
    std::copy(std::begin(contribution.unit.diffuse), std::end(contribution.unit.diffuse), std::begin(cluster.diffuse));
    cluster.lit = contribution.lit;
    cluster.unknown = contribution.unknown;
    cluster.any_clamped = contribution.unit.any_clamped;
    if (glossy_) {
        std::copy(std::begin(contribution.unit.f0), std::end(contribution.unit.f0), std::begin(lobes_[index].f0));
        std::copy(std::begin(contribution.unit.schlick), std::end(contribution.unit.schlick),
                  std::begin(lobes_[index].schlick));
    }
    if (translucent_) tints_[index] = contribution.tint;
}

}  // namespace render2mpeg::renderer
