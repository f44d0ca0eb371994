// Bottom-up clustering after [Walter2005, 4.1] in O(n log n): not with a heap of pairs but by merging all pairs of
// mutual nearest neighbours at once, looked for among the neighbours along a space-filling curve [Meister2018].
#include "renderer/light_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/light_clusters.h"

namespace render2mpeg::renderer {
namespace {

TreeLight tree_light(const LightPoint& p) {
    TreeLight light;
    light.position = p.kind == LightPointKind::directional ? -p.normal : p.position;
    light.normal = p.normal;
    light.intensity = p.intensity;
    light.id = p.id;
    light.disc2 = p.disc2;
    if (family_of(p.kind) == LightFamily::punctual) {
        light.disc2 = p.range > 0.0f ? p.range * p.range : std::numeric_limits<float>::infinity();
        if (p.kind == LightPointKind::spot) {
            light.spot_scale = p.spot_scale;
            light.spot_offset = p.spot_offset;
        }
    }
    return light;
}

/// A light that does not shine now; it lies nowhere, so that nothing depends on where it was.
TreeLight dark_light(std::uint32_t id) {
    TreeLight light;
    light.id = id;
    return light;
}

bool is_finite(const LightPoint& p) {
    return core::is_finite(p.intensity) && core::is_finite(p.position) && core::is_finite(p.normal);
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

bool same_bits(const TreeLight& a, const TreeLight& b) {
    return a.position == b.position && a.normal == b.normal && a.spot_scale == b.spot_scale &&
           a.spot_offset == b.spot_offset;
}

auto place_of(const TreeLight& l) {
    return std::array<float, 8>{l.position.x, l.position.y, l.position.z, l.normal.x,
                                l.normal.y,   l.normal.z,   l.spot_scale, l.spot_offset};
}

/// Sorts lights along a Z-order curve through their box [Morton1966], so that near lights have near indices. Coincident
/// lights that shine alike become one, unless all are to be kept.
void sort_and_merge(std::vector<TreeLight>& lights, LightFamily family, bool keep_all) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (const TreeLight& l : lights) {
        low = glm::min(low, l.position);
        high = glm::max(high, l.position);
    }
    const glm::vec3 size = high - low;
    const float longest = std::max({size.x, size.y, size.z});
    struct Keyed {
        std::uint64_t key;
        std::uint32_t index;
    };
    std::vector<Keyed> order(lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const glm::vec3 p = lights[i].position - low;
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
    std::vector<TreeLight> sorted;
    sorted.reserve(lights.size());
    glm::dvec3 sum(0);
    double disc2 = 0;
    for (const Keyed& k : order) {
        const TreeLight& l = lights[k.index];
        if (sorted.empty() || keep_all || !same_bits(sorted.back(), l)) {
            sorted.push_back(l);
            sum = l.intensity;
            disc2 = l.disc2;
            continue;
        }
        sum += glm::dvec3(l.intensity);
        sorted.back().intensity = glm::vec3(sum);
        disc2 = family == LightFamily::punctual ? std::max<double>(disc2, l.disc2) : disc2 + l.disc2;
        sorted.back().disc2 = static_cast<float>(disc2);
    }
    lights = std::move(sorted);
}

/// Puts nodes and lights in depth-first order, parents before children, so that a cut walks through near memory.
void reorder(LightTree& tree) {
    std::vector<LightNode> nodes;
    std::vector<TreeLight> lights;
    nodes.reserve(tree.nodes.size());
    lights.reserve(tree.lights.size());
    struct Visit {
        LightRef from;
        std::uint32_t parent;
        int side;
    };
    constexpr std::uint32_t no_parent = 0xffffffffu;
    std::vector<Visit> stack{{tree.root, no_parent, 0}};
    while (!stack.empty()) {
        const Visit v = stack.back();
        stack.pop_back();
        LightRef to;
        if (v.from.is_leaf()) {
            to = LightRef::leaf(static_cast<std::uint32_t>(lights.size()));
            lights.push_back(tree.lights[v.from.index()]);
        } else {
            const LightNode& node = tree.nodes[v.from.index()];
            to = LightRef::inner(static_cast<std::uint32_t>(nodes.size()));
            nodes.push_back(node);
            stack.push_back({node.child[1], to.index(), 1});
            stack.push_back({node.child[0], to.index(), 0});
        }
        if (v.parent == no_parent)
            tree.root = to;
        else
            nodes[v.parent].child[v.side] = to;
    }
    tree.nodes = std::move(nodes);
    tree.lights = std::move(lights);
}

}  // namespace

LightFamily family_of(LightPointKind kind) {
    switch (kind) {
        case LightPointKind::oriented:
            return LightFamily::oriented;
        case LightPointKind::directional:
            return LightFamily::directional;
        default:
            return LightFamily::punctual;
    }
}

namespace {

LightTree build(LightFamily family, std::span<const LightPoint> points, std::uint64_t seed, bool keep_all) {
    LightTree tree;
    tree.family = family;
    tree.lights.reserve(points.size());
    for (const LightPoint& p : points) {
        EXPECTS(family_of(p.kind) == family);
        if (is_finite(p) && (keep_all || core::luminance(p.intensity) > 0.0f)) tree.lights.push_back(tree_light(p));
    }
    if (tree.lights.empty()) return tree;
    sort_and_merge(tree.lights, family, keep_all);
    cluster(tree, seed);
    reorder(tree);
    seat_representatives(tree);
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

void seat_representatives(LightTree& tree) {
    std::vector<std::array<std::uint32_t, seated_sets>> seats(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        LightNode& node = tree.nodes[i];
        for (std::size_t set = 0; set < seated_sets; ++set) {
            const auto seat_of = [&](LightRef child) {
                return child.is_leaf() ? child.index() : seats[child.index()][set];
            };
            const bool first = (node.first_represents >> set & 1u) != 0;
            const std::uint32_t own = seat_of(node.child[first ? 0 : 1]), other = seat_of(node.child[first ? 1 : 0]);
            const std::int64_t distance = std::int64_t{other} - std::int64_t{own};
            const bool fits = std::abs(distance) <= std::numeric_limits<std::int16_t>::max();
            node.adopted[set] = fits ? static_cast<std::int16_t>(distance) : LightNode::far_away;
            seats[i][set] = own;
        }
    }
}

LightTree build_light_tree(LightFamily family, std::span<const LightPoint> points, std::uint64_t seed) {
    return build(family, points, seed, false);
}

LightTree build_lasting_tree(LightFamily family, std::span<const LightPoint> points, std::uint64_t seed) {
    return build(family, points, seed, true);
}

void update_light_tree(LightTree& tree, std::span<const LightPoint> points, std::uint64_t seed) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_id(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) by_id[i] = {points[i].id, i};
    std::sort(by_id.begin(), by_id.end());
    for (TreeLight& light : tree.lights) {
        const auto found = std::lower_bound(by_id.begin(), by_id.end(), std::pair{light.id, 0u});
        const bool there = found != by_id.end() && found->first == light.id && is_finite(points[found->second]);
        if (there)
            light = tree_light(points[found->second]);
        else
            light = dark_light(light.id);
    }
    refit(tree, seed);
    seat_representatives(tree);
}

TreePlan plan_of(const LightTree& tree) {
    TreePlan plan;
    plan.family = tree.family;
    plan.root = tree.root;
    plan.children.reserve(tree.nodes.size());
    plan.ids.reserve(tree.lights.size());
    for (const LightNode& node : tree.nodes) plan.children.push_back({node.child[0], node.child[1]});
    for (const TreeLight& light : tree.lights) plan.ids.push_back(light.id);
    return plan;
}

LightTree grow_light_tree(const TreePlan& plan, std::span<const LightPoint> points, std::uint64_t seed) {
    LightTree tree;
    tree.family = plan.family;
    tree.root = plan.root;
    tree.nodes.resize(plan.children.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
        std::copy(plan.children[i].begin(), plan.children[i].end(), std::begin(tree.nodes[i].child));
    tree.lights.reserve(plan.ids.size());
    for (const std::uint32_t id : plan.ids) tree.lights.push_back(dark_light(id));
    if (!tree.empty()) update_light_tree(tree, points, seed);
    return tree;
}

}  // namespace render2mpeg::renderer
