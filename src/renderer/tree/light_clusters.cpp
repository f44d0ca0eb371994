#include "renderer/tree/light_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/stream.h"

namespace render2mpeg::renderer {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Neighbours along the curve that are looked at to each side. chosen: 8 of 2 to 64 gives the cheapest tree
/// (docs/measurements.md#lightcuts); more look farther but merge more greedily at once.
constexpr std::ptrdiff_t reach = 8;

/// Widens stored cones by more than packing an axis may turn it (7e-5 rad).
constexpr float packing_angle = 1e-4f;

/// A cluster while it grows: one per root of the light trees.
struct GrowingCluster {
    glm::vec3 low, high;
    glm::vec3 axis;
    float half_angle;  ///< of the normal cone, radians, up to pi
    glm::vec3 intensity;
    float power;  ///< luminance of `intensity`
    float least_disc2, largest_disc2;
    LightRef ref;
    std::uint32_t least_id;  ///< of its lights
};

struct Cone {
    glm::vec3 axis;
    float half_angle;
};

float union_half_angle(float between, float a, float b) {
    if (between + b <= a) return a;
    if (between + a <= b) return b;
    return std::min(0.5f * (between + a + b), pi);
}

/// The smallest cone about two cones.
Cone join(const Cone& a, const Cone& b) {
    const float between = core::acos_clamped(glm::dot(a.axis, b.axis));
    const float half = union_half_angle(between, a.half_angle, b.half_angle);
    if (between + b.half_angle <= a.half_angle) return a;
    if (between + a.half_angle <= b.half_angle) return b;
    // Turn a's axis towards b's until its cone ends where the union does.
    glm::vec3 across = b.axis - glm::dot(a.axis, b.axis) * a.axis;
    glm::vec3 fallback, unused;
    core::make_frame(a.axis, fallback, unused);
    if (glm::dot(across, across) < 1e-12f) across = fallback;
    across = core::normalize_or(across, fallback);
    const float turn = half - a.half_angle;
    return {core::normalize_or(std::cos(turn) * a.axis + std::sin(turn) * across, a.axis), half};
}

/// The cost of one cluster [Walter2005, 4.1]. In double: intensities may differ by 1e24.
double cost(double power, glm::vec3 low, glm::vec3 high, float half_angle, double scale2) {
    const glm::dvec3 d(high - low);
    const double turn = 1.0f - std::cos(half_angle);
    return power * (glm::dot(d, d) + scale2 * turn * turn);
}

/// Arc cosine to 7e-5 rad, enough to compare costs, at a quarter of the time. [Hastings1955, sheet 35]
float rough_acos(float x) {
    const float m = std::min(std::abs(x), 1.0f);
    const float r = std::sqrt(1.0f - m) * (1.5707288f + m * (-0.2121144f + m * (0.0742610f - m * 0.0187293f)));
    return x < 0.0f ? pi - r : r;
}

double pair_cost(const GrowingCluster& a, const GrowingCluster& b, double scale2) {
    float half = 0.0f;
    if (scale2 > 0.0) half = union_half_angle(rough_acos(glm::dot(a.axis, b.axis)), a.half_angle, b.half_angle);
    return cost(static_cast<double>(a.power) + b.power, glm::min(a.low, b.low), glm::max(a.high, b.high), half, scale2);
}

GrowingCluster leaf_of(const LightTree& tree, std::uint32_t index) {
    const TreeLight& light = tree.lights[index];
    GrowingCluster c;
    c.low = c.high = light.position;
    c.axis = light.normal();
    c.half_angle = 0.0f;
    if (const Spot* spot = tree.spot(index))
        c.half_angle = spot->scale > 0.0f ? core::acos_clamped(-spot->offset / spot->scale) : pi;
    c.intensity = light.intensity;
    c.power = core::luminance(light.intensity);
    c.least_disc2 = c.largest_disc2 = light.disc2;
    c.ref = LightRef::leaf(index);
    c.least_id = (*tree.ids)[index];
    return c;
}

/// The box about all that shines.
core::Box shining_box(const LightTree& tree) {
    core::Box box;
    for (const TreeLight& l : tree.lights)
        if (core::luminance(l.intensity) > 0.0f) box.hold(l.position);
    return box;
}

/// How far directions count against distances: the diagonal of that box; not at all where light has no cosine. Trees of
/// the same shining lights have the same scale, whatever dark ones one of them keeps.
double direction_scale2(const LightTree& tree) {
    if (tree.type != LightType::oriented) return 0.0;
    const core::Box shining = shining_box(tree);
    if (!shining.any()) return 1.0;
    const glm::dvec3 d(shining.high - shining.low);
    const double scale2 = glm::dot(d, d);
    return scale2 > 0.0 ? scale2 : 1.0;
}

/// Bit k: set k takes the representative of the first of two clusters, whose share of both powers this is. Every set
/// for itself does so with a probability of `share`; together they are stratified, so that the mean over neighbouring
/// pixels errs less than that of independent dice. A function of persistent ids: as powers change the dice fall the
/// same, and a set changes its mind where the share crosses them and nowhere else.
std::uint16_t draw_first(double share, std::uint64_t seed, std::uint32_t first_id, std::uint32_t second_id) {
    const Stream numbers = Stream(Purpose::representatives, {.index = seed}).at(first_id).at(second_id);
    const double turn = numbers.uniform(0);
    std::uint64_t dice = numbers.at(1).bits();
    unsigned quarter[representative_sets] = {0, 1, 2, 3};
    for (unsigned left = representative_sets; left > 1; dice /= left, --left)
        std::swap(quarter[left - 1], quarter[dice % left]);
    unsigned sets = 0;
    for (int k = 0; k < representative_sets; ++k) {
        const double dropped = turn + quarter[k] / static_cast<double>(representative_sets);
        sets |= dropped - std::floor(dropped) < share ? 1u << k : 0u;
    }
    return static_cast<std::uint16_t>(sets);
}

/// The cluster of two. What is dark bounds nothing: it may lie anywhere.
GrowingCluster joined(const GrowingCluster& a, const GrowingCluster& b) {
    GrowingCluster c;
    if ((a.power > 0.0f) != (b.power > 0.0f)) {
        c = a.power > 0.0f ? a : b;
        c.least_id = std::min(a.least_id, b.least_id);
        return c;
    }
    c.low = glm::min(a.low, b.low);
    c.high = glm::max(a.high, b.high);
    const Cone cone = join({a.axis, a.half_angle}, {b.axis, b.half_angle});
    c.axis = cone.axis;
    c.half_angle = cone.half_angle;
    c.intensity = a.intensity + b.intensity;
    c.power = a.power + b.power;
    c.least_disc2 = std::min(a.least_disc2, b.least_disc2);
    c.largest_disc2 = std::max(a.largest_disc2, b.largest_disc2);
    c.least_id = std::min(a.least_id, b.least_id);
    return c;
}

/// Sets all of a node but its children.
void set_node(LightNode& node, const BoxGrid& grid, const GrowingCluster& c, const GrowingCluster& a,
              const GrowingCluster& b, std::uint64_t seed) {
    // Dark clusters may lie anywhere.
    node.box = c.power > 0.0f ? PackedBox(grid, c.low, c.high) : PackedBox();
    node.intensity = PackedLight(c.intensity);
    node.cone = PackedCone(std::min(c.half_angle + packing_angle, pi));
    node.axis = core::PackedNormal(c.axis);
    node.disc2 = Disc2Range(c.least_disc2, c.largest_disc2);
    const double share = core::divide_or(static_cast<double>(a.power), static_cast<double>(a.power) + b.power, 0.5);
    node.first_represents = draw_first(share, seed, a.least_id, b.least_id);
}

/// The best partner of every cluster within reach. Equal costs prefer the pair whose indices differ in the lowest bits:
/// a symmetric rule, so that a lattice of equal lights pairs up at once.
void find_partners(const std::vector<GrowingCluster>& clusters, double scale2, std::vector<std::uint32_t>& partner) {
    const auto n = static_cast<std::ptrdiff_t>(clusters.size());
    partner.resize(clusters.size());
    parallel::for_ranges(clusters.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (auto i = static_cast<std::ptrdiff_t>(first); i < static_cast<std::ptrdiff_t>(last); ++i) {
            double best = std::numeric_limits<double>::infinity();
            std::ptrdiff_t choice = i > 0 ? i - 1 : i + 1;
            for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - reach); j < std::min(n, i + reach + 1); ++j) {
                if (j == i) continue;
                const double c = pair_cost(clusters[i], clusters[j], scale2);
                if (c < best || (c == best && (i ^ j) < (i ^ choice))) {
                    best = c;
                    choice = j;
                }
            }
            partner[i] = static_cast<std::uint32_t>(choice);
        }
    });
}

}  // namespace

std::vector<LightPair> cluster(const LightTree& tree) {
    const double scale2 = direction_scale2(tree);
    std::vector<GrowingCluster> clusters, next;
    clusters.reserve(tree.lights.size());
    for (std::uint32_t i = 0; i < tree.lights.size(); ++i) clusters.push_back(leaf_of(tree, i));
    std::vector<LightPair> pairs;
    pairs.reserve(tree.lights.size() - 1);
    const auto merge = [&pairs](const GrowingCluster& a, const GrowingCluster& b) {
        GrowingCluster both = joined(a, b);
        both.ref = LightRef::inner(static_cast<std::uint32_t>(pairs.size()));
        pairs.push_back({a.ref, b.ref});
        return both;
    };

    std::vector<std::uint32_t> partner;
    while (clusters.size() > 1) {
        find_partners(clusters, scale2, partner);
        std::size_t mutual = 0;
        for (std::size_t i = 0; i < clusters.size(); ++i) mutual += partner[i] > i && partner[partner[i]] == i ? 1 : 0;
        // Chains of ever nearer neighbours could pair up one by one: then pair by order, which keeps the build in O(n
        // log n).
        if (mutual * 256 < clusters.size())
            for (std::size_t i = 0; i < clusters.size(); ++i)
                partner[i] = static_cast<std::uint32_t>(std::min(i ^ 1, clusters.size() - 1));
        next.clear();
        for (std::size_t i = 0; i < clusters.size(); ++i) {
            const std::size_t j = partner[i];
            const bool paired = j != i && partner[j] == i;
            if (paired && j < i) continue;
            next.push_back(paired ? merge(clusters[i], clusters[j]) : clusters[i]);
        }
        clusters.swap(next);
    }
    return pairs;
}

void refit(LightTree& tree, std::uint64_t seed) {
    const core::Box shining = shining_box(tree);
    tree.grid = shining.any() ? BoxGrid(shining.low, shining.high) : BoxGrid();
    // From the leaves up: what ends last lies on top.
    std::vector<GrowingCluster> stack;
    const auto take = [&](LightRef child) {
        if (child.is_leaf()) return leaf_of(tree, child.index());
        const GrowingCluster inner = stack.back();
        stack.pop_back();
        return inner;
    };
    for (auto i = static_cast<std::uint32_t>(tree.nodes.size()); i-- > 0;) {
        LightNode& node = tree.nodes[i];
        const GrowingCluster a = take(node.child(i, 0)), b = take(node.child(i, 1));
        stack.push_back(joined(a, b));
        set_node(node, tree.grid, stack.back(), a, b, seed);
    }
}

double cost_of(const LightTree& tree) {
    if (tree.empty()) return 0.0;
    const double scale2 = direction_scale2(tree);
    double sum = 0.0;
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
        const MiddleBox box = tree.box(i);
        sum += cost(core::luminance(tree.intensity(LightRef::inner(i))), box.middle - box.half, box.middle + box.half,
                    core::acos_clamped(tree.nodes[i].cone.cosine()), scale2);
    }
    return sum;
}

}  // namespace render2mpeg::renderer
