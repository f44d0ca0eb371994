// Bottom-up clustering after [Walter2005, 4.1] in O(n log n): not with a heap of pairs but by merging all pairs of
// mutual nearest neighbours at once, looked for among the neighbours along a space-filling curve [Meister2018].
#include "renderer/tree/light_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/box.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/tree/light_clusters.h"

namespace render2mpeg::renderer {
namespace {

/// A light, and what a tree of others needs not.
struct LooseLight {
    TreeLight light;
    Spot spot;
    std::uint32_t id = 0;
};

LooseLight loose_light(const LightPoint& p) {
    LooseLight loose;
    TreeLight& light = loose.light;
    light.position = p.is_far() ? -p.normal : p.position;
    light.axis = core::PackedNormal(p.normal);
    light.intensity = p.intensity;
    light.disc2 = p.disc2;
    loose.id = p.id;
    loose.spot = p.spot;
    if (p.type == LightType::punctual)
        light.disc2 = p.range > 0.0f ? p.range * p.range : std::numeric_limits<float>::infinity();
    return loose;
}

/// Spreads the lowest 21 bits so that two zeros follow each.
std::uint64_t spread(std::uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    return (v | v << 2) & 0x1249249249249249ull;
}

auto place_of(const LooseLight& l) {
    const glm::vec3 p = l.light.position, n = l.light.normal();
    return std::array<float, 9>{p.x, p.y, p.z, n.x, n.y, n.z, l.spot.scale, l.spot.offset, l.spot.smooth};
}

/// Sorts lights along a Z-order curve through their box [Morton1966], so that near lights have near indices. Coincident
/// lights that shine alike become one, unless all are to be kept.
void sort_and_merge(std::vector<LooseLight>& lights, LightType type, bool keep_all) {
    core::Box box;
    for (const LooseLight& l : lights) box.hold(l.light.position);
    const glm::vec3 size = box.size(), low = box.low;
    const float longest = std::max({size.x, size.y, size.z});
    struct Keyed {
        std::uint64_t key;
        std::uint32_t index;
    };
    std::vector<Keyed> order(lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const glm::vec3 p = lights[i].light.position - low;
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k)
            key |= spread(static_cast<std::uint64_t>(core::divide_or(p[k], longest, 0.0f) * 2097151.0f)) << k;
        order[i] = {key, static_cast<std::uint32_t>(i)};
    }
    std::sort(order.begin(), order.end(), [&](const Keyed& a, const Keyed& b) {
        if (a.key != b.key) return a.key < b.key;
        const auto pa = place_of(lights[a.index]), pb = place_of(lights[b.index]);
        return pa != pb ? pa < pb : a.index < b.index;
    });
    std::vector<LooseLight> sorted;
    sorted.reserve(lights.size());
    glm::dvec3 sum(0);
    double disc2 = 0;
    for (const Keyed& k : order) {
        const LooseLight& l = lights[k.index];
        if (sorted.empty() || keep_all || place_of(sorted.back()) != place_of(l)) {
            sorted.push_back(l);
            sum = l.light.intensity;
            disc2 = l.light.disc2;
            continue;
        }
        TreeLight& merged = sorted.back().light;
        sum += glm::dvec3(l.light.intensity);
        merged.intensity = glm::vec3(sum);
        disc2 = type == LightType::punctual ? std::max<double>(disc2, l.light.disc2) : disc2 + l.light.disc2;
        merged.disc2 = static_cast<float>(disc2);
    }
    lights = std::move(sorted);
}

/// Gives nodes in depth-first order their children: of each, whether the first and the second is a light.
void set_children(const std::vector<bool>& leaves, LightTree& tree) {
    /// A node of which not all is known yet: in its first child, or in its second.
    struct Open {
        std::uint32_t node;
        bool in_second;
    };
    std::vector<Open> open;
    std::uint32_t light = 0;
    const auto count = static_cast<std::uint32_t>(tree.nodes.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!leaves[2 * i]) {
            open.push_back({i, false});
            continue;
        }
        const LightRef first = LightRef::leaf(light++);
        if (!leaves[2 * i + 1]) {
            tree.nodes[i].set_children(i, first, LightRef::inner(i + 1));
            open.push_back({i, true});
            continue;
        }
        tree.nodes[i].set_children(i, first, LightRef::leaf(light++));
        // Subtrees that end with this node end.
        for (; !open.empty(); open.pop_back()) {
            const std::uint32_t above = open.back().node;
            if (open.back().in_second) continue;
            const bool leaf = leaves[2 * above + 1];
            const LightRef second = leaf ? LightRef::leaf(light++) : LightRef::inner(i + 1);
            tree.nodes[above].set_children(above, LightRef::inner(above + 1), second);
            if (leaf) continue;
            open.back().in_second = true;
            break;
        }
    }
    tree.root = count == 0 ? LightRef::leaf(0) : LightRef::inner(0);
}

/// Puts the nodes of pairs, and lights, in depth-first order, parents before children, so that a cut walks through near
/// memory.
void put_in_order(const std::vector<LightPair>& pairs, LightTree& tree) {
    std::vector<TreeLight> lights;
    std::vector<Spot> spots;
    std::vector<std::uint32_t> ids;
    lights.reserve(tree.lights.size());
    ids.reserve(tree.lights.size());
    tree.nodes.resize(pairs.size());
    TreeTopology topology;
    topology.leaves.reserve(2 * pairs.size());
    std::vector<LightRef> stack{pairs.empty() ? LightRef::leaf(0)
                                              : LightRef::inner(static_cast<std::uint32_t>(pairs.size() - 1))};
    while (!stack.empty()) {
        const LightRef from = stack.back();
        stack.pop_back();
        if (from.is_leaf()) {
            lights.push_back(tree.lights[from.index()]);
            if (!tree.spots.empty()) spots.push_back(tree.spots[from.index()]);
            ids.push_back((*tree.ids)[from.index()]);
            continue;
        }
        const LightPair& pair = pairs[from.index()];
        topology.leaves.push_back(pair[0].is_leaf());
        topology.leaves.push_back(pair[1].is_leaf());
        stack.push_back(pair[1]);
        stack.push_back(pair[0]);
    }
    tree.lights = std::move(lights);
    tree.spots = std::move(spots);
    tree.ids = std::make_shared<const std::vector<std::uint32_t>>(std::move(ids));
    set_children(topology.leaves, tree);
}

LightTree build(LightType type, std::span<const LightPoint> points, std::uint64_t seed, bool keep_all) {
    LightTree tree;
    tree.type = type;
    std::vector<LooseLight> lights;
    lights.reserve(points.size());
    for (const LightPoint& p : points) {
        EXPECTS(p.type == type);
        if (is_finite(p) && (keep_all || core::luminance(p.intensity) > 0.0f)) lights.push_back(loose_light(p));
    }
    if (lights.empty()) return tree;
    sort_and_merge(lights, type, keep_all);
    std::vector<std::uint32_t> ids;
    tree.lights.reserve(lights.size());
    ids.reserve(lights.size());
    for (const LooseLight& l : lights) {
        tree.lights.push_back(l.light);
        if (type == LightType::punctual) tree.spots.push_back(l.spot);
        ids.push_back(l.id);
    }
    lights = {};
    tree.ids = std::make_shared<const std::vector<std::uint32_t>>(std::move(ids));
    put_in_order(cluster(tree), tree);
    refit(tree, seed);
    cache_representatives(tree);
    return tree;
}

}  // namespace

Disc2Range::Disc2Range(float least, float largest) {
    const auto low = std::bit_cast<std::uint32_t>(least), high = std::bit_cast<std::uint32_t>(largest);
    least_ = static_cast<std::uint16_t>(low >> 16);
    largest_ = static_cast<std::uint16_t>((high + 0xffffu) >> 16);
}

PackedCone::PackedCone(float half_angle)
    : sine_(static_cast<std::uint16_t>(std::min(std::ceil(65535.0f * std::sin(0.5f * half_angle)), 65535.0f))) {}

void LightNode::set_children(std::uint32_t self, LightRef first, LightRef second) {
    const bool leaf = first.is_leaf();
    const LightRef unknown = leaf ? first : second;
    EXPECTS(unknown.index() < second_is_leaf);
    children_ = unknown.index() | (leaf ? first_is_leaf : 0) | (second.is_leaf() ? second_is_leaf : 0);
    EXPECTS(child(self, 0) == first && child(self, 1) == second);
}

void cache_representatives(LightTree& tree) {
    // From the leaves up: who stands for what ends last lies on top.
    using Lights = std::array<std::uint32_t, representative_sets>;
    std::vector<Lights> stack;
    const auto take = [&](LightRef child) {
        Lights lights;
        if (child.is_leaf()) {
            lights.fill(child.index());
        } else {
            lights = stack.back();
            stack.pop_back();
        }
        return lights;
    };
    for (auto i = static_cast<std::uint32_t>(tree.nodes.size()); i-- > 0;) {
        LightNode& node = tree.nodes[i];
        const Lights of_first = take(node.child(i, 0)), of_second = take(node.child(i, 1));
        Lights own;
        for (std::size_t set = 0; set < representative_sets; ++set) {
            const bool first = (node.first_represents >> set & 1u) != 0;
            own[set] = first ? of_first[set] : of_second[set];
            const std::int64_t distance = std::int64_t{first ? of_second[set] : of_first[set]} - std::int64_t{own[set]};
            const bool fits = std::abs(distance) <= std::numeric_limits<std::int16_t>::max();
            node.other_representative[set] = fits ? static_cast<std::int16_t>(distance) : LightNode::far_away;
        }
        stack.push_back(own);
    }
}

LightTree build_light_tree(LightType type, std::span<const LightPoint> points, std::uint64_t seed) {
    return build(type, points, seed, false);
}

LightTree build_persistent_tree(LightType type, std::span<const LightPoint> points, std::uint64_t seed) {
    return build(type, points, seed, true);
}

void update_light_tree(LightTree& tree, std::span<const LightPoint> points, std::uint64_t seed) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_id(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) by_id[i] = {points[i].id, i};
    if (!std::is_sorted(by_id.begin(), by_id.end())) std::sort(by_id.begin(), by_id.end());
    for (std::size_t i = 0; i < tree.lights.size(); ++i) {
        const std::uint32_t id = (*tree.ids)[i];
        const auto found = std::lower_bound(by_id.begin(), by_id.end(), std::pair{id, 0u});
        const bool there = found != by_id.end() && found->first == id && is_finite(points[found->second]);
        // One that does not shine now lies nowhere, so that nothing depends on where it was.
        const LooseLight loose = there ? loose_light(points[found->second]) : LooseLight{};
        tree.lights[i] = loose.light;
        if (!tree.spots.empty()) tree.spots[i] = loose.spot;
    }
    refit(tree, seed);
    cache_representatives(tree);
}

std::size_t TreeTopology::bytes() const {
    return leaves.capacity() / 8 + (ids ? ids->capacity() * sizeof(std::uint32_t) : 0);
}

TreeTopology topology_of(const LightTree& tree) {
    TreeTopology topology;
    topology.type = tree.type;
    topology.ids = tree.ids;
    topology.leaves.reserve(2 * tree.nodes.size());
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i)
        for (const int side : {0, 1}) topology.leaves.push_back(tree.child(i, side).is_leaf());
    return topology;
}

LightTree build_from_topology(const TreeTopology& topology, std::span<const LightPoint> points, std::uint64_t seed) {
    LightTree tree;
    tree.type = topology.type;
    tree.ids = topology.ids;
    tree.nodes.resize(topology.leaves.size() / 2);
    tree.lights.resize(topology.lights());
    if (topology.type == LightType::punctual) tree.spots.resize(topology.lights());
    if (tree.empty()) return tree;
    set_children(topology.leaves, tree);
    update_light_tree(tree, points, seed);
    return tree;
}

}  // namespace render2mpeg::renderer
