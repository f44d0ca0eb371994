#include "renderer/tree/light_trees.h"

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/tree/light_clusters.h"

namespace render2mpeg::renderer {
namespace {

/// How much more an updated tree may cost than one built for the instant before it is. chosen: 1.5, which a lamp on
/// its way through a room does not reach (cuts of at most 1.1 times the fresh tree's; test), and things that change
/// places do.
constexpr double most_cost = 1.5;

/// Least weight of a light when a tree is rebuilt, as a share of the lights' mean: it may be lit later.
constexpr float least_counted = 0.01f;

/// Whether a light is punctual: a true point or beam, not a sample of something larger.
bool is_punctual(const LightPoint& p) {
    return !p.is_of_surface() && p.disc2 == 0.0f;
}

using PointsByType = std::array<std::vector<LightPoint>, LightTrees::direct_trees>;

void add_exact(const LightPoint& p, std::uint64_t seed, std::vector<ExactLight>& exact) {
    const LightPoint one[] = {p};
    const LightTree tree = build_light_tree(p.type, one, seed);
    if (!tree.empty())
        exact.push_back({tree.type, tree.lights.front(), tree.spots.empty() ? Spot{} : tree.spots.front()});
}

/// All lights of a topology as they lie now, to rebuild it by; those that are absent lie with their neighbours in the
/// tree.
std::vector<LightPoint> with_absent(const TreeTopology& topology, std::span<const LightPoint> now) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_id;
    glm::dvec3 sum(0);
    for (std::uint32_t i = 0; i < now.size(); ++i) {
        if (!is_finite(now[i])) continue;
        by_id.emplace_back(now[i].id, i);
        sum += glm::dvec3(now[i].intensity);
    }
    std::vector<LightPoint> all;
    if (by_id.empty()) return all;
    std::sort(by_id.begin(), by_id.end());
    const auto least = glm::vec3(sum * (least_counted / static_cast<double>(topology.lights()))) + glm::vec3(1e-20f);
    const LightPoint* last = &now[by_id.front().second];
    all.reserve(topology.lights());
    for (const std::uint32_t id : *topology.ids) {
        const auto found = std::lower_bound(by_id.begin(), by_id.end(), std::pair{id, 0u});
        const bool there = found != by_id.end() && found->first == id;
        if (there) last = &now[found->second];
        LightPoint p = *last;
        p.id = id;
        p.intensity = (there ? p.intensity : glm::vec3(0)) + least;
        all.push_back(p);
    }
    return all;
}

}  // namespace

PersistentLightTrees::PersistentLightTrees(std::span<const LightPoint> average, std::uint64_t seed) : seed_(seed) {
    const auto punctual = std::count_if(average.begin(), average.end(), is_punctual);
    PointsByType types;
    for (const LightPoint& p : average) {
        if (is_punctual(p) && static_cast<std::size_t>(punctual) <= most_exact_lights)
            exact_.push_back(p.id);
        else
            types[static_cast<std::size_t>(p.type)].push_back(p);
    }
    std::sort(exact_.begin(), exact_.end());
    for (std::size_t t = 0; t < types.size(); ++t)
        topologies_[t] = topology_of(build_persistent_tree(static_cast<LightType>(t), types[t], seed));
}

LightTrees PersistentLightTrees::at(std::span<const LightPoint> now, bool may_rebuild) {
    LightTrees light_trees;
    PointsByType types;
    for (const LightPoint& p : now) {
        if (std::binary_search(exact_.begin(), exact_.end(), p.id))
            add_exact(p, seed_, light_trees.exact);
        else
            types[static_cast<std::size_t>(p.type)].push_back(p);
    }
    for (std::size_t t = 0; t < types.size(); ++t) {
        const std::span<const LightPoint> points = types[t];
        LightTree& tree = light_trees.trees[t];
        tree = build_from_topology(topologies_[t], points, seed_);
        if (tree.empty()) continue;
        // A dark tree would be asked about for nothing.
        if (!(core::luminance(tree.intensity(tree.root)) > 0.0f)) {
            tree = {};
            tree.type = topologies_[t].type;
            continue;
        }
        if (!may_rebuild) continue;
        TreeTopology other = topology_of(build_persistent_tree(tree.type, with_absent(topologies_[t], points), seed_));
        LightTree fresh = build_from_topology(other, points, seed_);
        if (cost_of(tree) <= most_cost * cost_of(fresh)) continue;
        tree = std::move(fresh);
        topologies_[t] = std::move(other);
    }
    return light_trees;
}

std::size_t PersistentLightTrees::bytes() const {
    std::size_t sum = exact_.capacity() * sizeof(std::uint32_t);
    for (const TreeTopology& topology : topologies_) sum += topology.bytes();
    return sum;
}

}  // namespace render2mpeg::renderer
