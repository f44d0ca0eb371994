#include "renderer/cut/finished_cut.h"

#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

/// The clusters two levels below one, as their representatives: its geometry is summed over them.
struct Parts {
    std::uint32_t light[4];
    glm::vec3 intensity[4];
    int count = 0;
};

Parts parts_of(const LightTree& tree, const Cluster& cluster, int set) {
    Parts parts;
    const auto take = [&](LightRef part, std::uint32_t light) {
        parts.light[parts.count] = light;
        parts.intensity[parts.count] = tree.intensity(part);
        ++parts.count;
    };
    // Calls `use` with both children of a node and their representatives.
    const auto both = [&](LightRef inner, std::uint32_t own, const auto& use) {
        const bool first = tree.first_represents(inner, set);
        const std::uint32_t other = tree.other_representative(inner, own, set);
        use(tree.child(inner.index(), 0), first ? own : other);
        use(tree.child(inner.index(), 1), first ? other : own);
    };
    // Of the children those that are lights stay as they are.
    both(cluster.ref, cluster.representative, [&](LightRef child, std::uint32_t light) {
        if (child.is_leaf())
            take(child, light);
        else
            both(child, light, take);
    });
    return parts;
}

/// Lanes without a lobe, nothing translucent: all parts at once.
RENDER2MPEG_CLONES
void add_diffuse_parts(const LightTree& tree, const GatherLanes& lanes, GeometryClamp clamp, const Cluster& cluster,
                       const Parts& parts, bool direct, CutSums& sums) {
    alignas(64) Lanes visible;
    for (int i = 0; i < lane_count; ++i) visible[i] = visible_share(cluster, i);
    Representative lights[4];
    for (int p = 0; p < parts.count; ++p)
        lights[p] = {&tree.lights[parts.light[p]], tree.spot(parts.light[p]), parts.intensity[p]};
    alignas(64) RgbLanes irradiance{};
    add_irradiance(lanes, tree.type, lights, parts.count, clamp, irradiance);
    sums.add(irradiance, visible, direct);
}

/// Any lanes: part by part. `own`: light of the representative, visibility included.
RENDER2MPEG_CLONES
void add_parts(const LightTree& tree, const GatherLanes& lanes, GeometryClamp clamp, const Cluster& cluster,
               const UnitLight& own, const Parts& parts, bool direct, CutSums& sums) {
    for (int p = 0; p < parts.count; ++p) {
        const std::uint32_t light = parts.light[p];
        if (light == cluster.representative) {
            sums.add(own, parts.intensity[p], direct);
            continue;
        }
        LightLanes unit;
        evaluate_light(lanes, tree.type, tree.lights[light], tree.spot(light), clamp, unit);
        for (int i = 0; i < lane_count; ++i) {
            const float visible = visible_share(cluster, i);
            unit.diffuse[i] *= visible;
            if (!lanes.glossy) continue;
            unit.f0[i] *= visible;
            unit.schlick[i] *= visible;
        }
        const bool glossy = own.f0 != nullptr;
        sums.add({unit.diffuse, glossy ? &unit.f0 : nullptr, glossy ? &unit.schlick : nullptr, own.passes},
                 parts.intensity[p], direct);
    }
}

}  // namespace

void sum_clusters(const LightTrees& light_trees, const GatherLanes& lanes, const Clusters& clusters, CutSums& sums,
                  GatheredLight& out) {
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        const Cluster& cluster = clusters[c];
        const LightTree& tree = light_trees.trees[cluster.tree];
        const bool direct = LightTrees::is_direct(cluster.tree);
        const GeometryClamp clamp = light_trees.clamp(cluster.tree);
        if (cluster.ref.is_leaf())
            sums.add(clusters.unit(c), cluster.intensity, direct);
        else if (cluster.lit != 0 && !lanes.glossy && !light_trees.translucent)
            add_diffuse_parts(tree, lanes, clamp, cluster, parts_of(tree, cluster, lanes.set), direct, sums);
        else if (cluster.lit != 0)
            add_parts(tree, lanes, clamp, cluster, clusters.unit(c), parts_of(tree, cluster, lanes.set), direct, sums);
        if (cluster.any_clamped)
            sums.add_clamped(tree.lights[cluster.representative], clusters.unit(c), cluster.intensity, clamp);
        ++(direct ? out.direct_clusters : out.indirect_clusters);
    }
}

}  // namespace render2mpeg::renderer
