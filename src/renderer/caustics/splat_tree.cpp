// After [Herzog2007, 4.2]: light falls off with the distance from the photon's way, and each receiver has its own
// cosine. Changed: ellipses (caustic_photons.h); in place of frustums in a k-d tree of nodes that know their normals,
// boxes of points, which photons are sorted into first, so that threads need not share what they add to; and visibility
// [HerzogThesis, 5] by exact rays for the few pairs that need one.
#include "renderer/caustics/splat_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Points of a leaf: the lanes of the innermost loop.
constexpr std::uint32_t leaf_size = 16;

/// Halvings until parts are spread over by one thread each: 256 of them.
constexpr int part_depth = 8;

/// Points so far along the way from a landing, in its semi-axes, are lit by it; on the landing's own plane no limit.
/// [Herzog2007, 4.3.3: the end of the ray]
constexpr float reach_along = 2.0f;

/// Grazing light spreads along the surface, by no more than so many semi-axes. chosen: 8, light at 7 degrees.
constexpr float most_stretch = 8.0f;

/// A point is on the landing's surface where it lies on the same object, within this share of the semi-axis of its
/// plane, and faces as it does; no ray is needed then. chosen: 0.3; 0.1 asks twice the rays for the same picture.
constexpr float same_plane_share = 0.3f, same_facing = 0.5f;

/// Shadow rays of doubtful pairs end after so many semi-axes: what is farther off casts the photons' own shadow.
constexpr float doubt_reach = 4.0f;

float stretch_of(const Landing& landing) {
    const float cosine = std::abs(glm::dot(landing.direction, landing.normal));
    return std::min(1.0f / std::max(cosine, 1e-3f), most_stretch);
}

float reach_of(const Landing& landing, const Footprint& footprint) {
    return footprint.widest * std::max(stretch_of(landing), std::sqrt(1.0f + reach_along * reach_along));
}

SplatQuery query_of(const Landing& landing, const Footprint& f) {
    SplatQuery q;
    q.position = landing.position;
    q.direction = landing.direction;
    q.normal = landing.normal;
    q.object = landing.object;
    // The inverse as a product of a triangle and itself, turned over.
    const float a = std::sqrt(f.inverse[0][0]);
    const float b = core::divide_or(f.inverse[0][1], a, 0.0f);
    q.axes[0] = a * f.across[0] + b * f.across[1];
    q.axes[1] = std::sqrt(std::max(f.inverse[1][1] - b * b, 0.0f)) * f.across[1];
    q.peak = f.peak;
    q.plane = same_plane_share * f.widest;
    q.along = reach_along * f.widest;
    q.least_facing = same_facing;
    return q;
}

/// Mean direction of the light that the footprint brings to a place: a lobe sees a spot of light where it is, however
/// far photons stand apart.
glm::vec3 direction_at(const Landing& landing, const Footprint& f, glm::vec3 place) {
    const glm::vec3 e = place - landing.position;
    const glm::vec3 turned =
        landing.direction + glm::dot(e, f.across[0]) * f.turn[0] + glm::dot(e, f.across[1]) * f.turn[1];
    return core::normalize_or(turned, landing.direction);
}

/// A surface that scatters the mean direction as it would all that a footprint brings.
Bsdf widened(Bsdf bsdf, float blur) {
    // Half vectors turn by half, and a lobe's squared width is twice their variance along an axis.
    const float more = 0.25f * blur;
    const auto wider = [&](float alpha) { return std::min(std::sqrt(alpha * alpha + more), 1.0f); };
    bsdf.alpha = wider(bsdf.alpha);
    bsdf.alpha_along = wider(bsdf.alpha_along);
    return bsdf;
}

/// Whether a box may hold points that the landing lights: within `radius`, and within the rectangle about the ellipse.
bool touches(glm::vec3 low, glm::vec3 high, const SplatQuery& query, float radius) {
    const glm::vec3 away = glm::max(glm::max(low - query.position, query.position - high), glm::vec3{0.0f});
    if (glm::dot(away, away) > radius * radius) return false;
    const glm::vec3 middle = 0.5f * (low + high) - query.position, half = 0.5f * (high - low);
    // chosen: a thousandth for rounding, as inner loops round otherwise.
    constexpr float outward = 1.001f;
    for (const glm::vec3& axis : query.axes)
        if (std::abs(glm::dot(middle, axis)) > outward * (1.0f + glm::dot(half, glm::abs(axis)))) return false;
    return true;
}

/// When light meets a point: with its photon, but in the middle of the shutter what moves, as its points lie then.
float time_at(const PosedScene& scene, const Landing& landing, const GatherPoint& g) {
    if (landing.time == scene::middle_time) return landing.time;
    return scene.posed().sweep->object_moves(g.point.address.object) ? scene::middle_time : landing.time;
}

/// Whether light that goes the landing's way meets the point: nothing but what threw it lies just before.
bool is_open(const PosedScene& scene, const Landing& landing, const GatherPoint& g, float far) {
    const Hit hit = scene.tracer().nearest(shadow_origin(g.point), -landing.direction, far, time_at(scene, landing, g));
    return !hit.found() || hit.address.object == landing.caster;
}

}  // namespace

Footprint footprint_of(const Landing& landing, float pixel, float limit) {
    Footprint f;
    core::make_frame(landing.direction, f.across[0], f.across[1]);
    glm::mat2 k(pixel * pixel + landing.spread * landing.spread);
    glm::vec3 turns[2]{};  // sums of changes of direction by places, as `k` has of places by places
    for (std::size_t e = 0; e < landing.edges.size(); ++e) {
        const glm::vec2 v(glm::dot(landing.edges[e], f.across[0]), glm::dot(landing.edges[e], f.across[1]));
        k += glm::outerProduct(v, v);
        for (int i = 0; i < 2; ++i) turns[i] += v[i] * landing.turns[e];
    }
    const float middle = 0.5f * (k[0][0] + k[1][1]), half = 0.5f * (k[0][0] - k[1][1]);
    const float offset = std::sqrt(half * half + k[0][1] * k[0][1]);
    const float largest = middle + offset;
    float determinant = k[0][0] * k[1][1] - k[0][1] * k[0][1];
    if (!std::isfinite(largest) || !(largest > 0.0f)) return f;
    for (int i = 0; i < 2; ++i)
        f.turn[i] = 1.0f / std::max(determinant, 1e-6f * largest * largest) *
                    (k[1 - i][1 - i] * turns[i] - k[0][1] * turns[1 - i]);
    // Variances of the kernel are a sixth of its squared semi-axes. What turns by an angle errs by half of its square
    // from a linear map; where that is more than what there is, the map says nothing.
    float whole = 0, mapped = 0;
    for (const glm::vec3& turn : landing.turns) whole += glm::dot(turn, turn) / 6.0f;
    if (!std::isfinite(whole)) return f;
    for (int i = 0; i < 2; ++i) mapped += glm::dot(turns[i], f.turn[i]) / 6.0f;
    f.blur = std::max(whole - mapped, 0.0f) + 0.5f * whole * whole;
    if (!(f.blur < whole)) {
        f.blur = whole;
        f.turn[0] = f.turn[1] = glm::vec3(0);
    }
    if (largest > limit * limit) {
        // Too wide along one axis: shrink the whole, so that its light stays near.
        const float scale = limit * limit / largest;
        k *= scale;
        determinant *= scale * scale;
    }
    f.widest = std::min(std::sqrt(largest), limit);
    determinant = std::max(determinant, 1e-6f * f.widest * f.widest * f.widest * f.widest);
    f.inverse = glm::mat2(k[1][1], -k[0][1], -k[0][1], k[0][0]) / determinant;
    f.peak = 2.0f * std::numbers::inv_pi_v<float> / std::sqrt(determinant);
    return f;
}

SplatTree::SplatTree(const Frame& seen) {
    std::size_t count = 0;
    for (const GatherTile& tile : seen.tiles) count += tile.size();
    points_.reserve(count);
    for (std::uint32_t t = 0; t < seen.tiles.size(); ++t)
        for (std::uint32_t i = 0; i < seen.tiles[t].size(); ++i)
            points_.push_back({seen.tiles[t][i].point.position, &seen.tiles[t][i], t, i});
    if (points_.empty()) return;
    build(0, static_cast<std::uint32_t>(points_.size()), 0);
    fill_lanes();
}

void SplatTree::fill_lanes() {
    for (const Node& n : nodes_) {
        if (n.right != 0) continue;
        SplatPoints lanes{};
        for (std::uint32_t k = n.first; k < n.last; ++k) {
            const SurfacePoint& p = points_[k].point->point;
            const std::uint32_t i = k - n.first;
            lanes.x[i] = p.position.x;
            lanes.y[i] = p.position.y;
            lanes.z[i] = p.position.z;
            lanes.shading_x[i] = p.shading_normal.x;
            lanes.shading_y[i] = p.shading_normal.y;
            lanes.shading_z[i] = p.shading_normal.z;
            lanes.geometric_x[i] = p.geometric_normal.x;
            lanes.geometric_y[i] = p.geometric_normal.y;
            lanes.geometric_z[i] = p.geometric_normal.z;
            lanes.object[i] = p.address.object;
        }
        leaves_.push_back(lanes);
    }
}

void SplatTree::build(std::uint32_t first, std::uint32_t last, int depth) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{points_[first].position, points_[first].position, first, last, 0};
    for (std::uint32_t i = first; i < last; ++i) {
        node.low = glm::min(node.low, points_[i].position);
        node.high = glm::max(node.high, points_[i].position);
    }
    node.leaf = leaf_count_;
    nodes_.push_back(node);
    const bool leaf = last - first <= leaf_size;
    part_of_node_.push_back(-1);
    if (depth == part_depth || (leaf && depth < part_depth)) {
        part_of_node_[index] = static_cast<std::int32_t>(parts_.size());
        parts_.push_back(index);
    }
    if (leaf) {
        ++leaf_count_;
        return;
    }
    const int axis = core::Box{node.low, node.high}.longest_axis();
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + last,
                     [axis](const Entry& a, const Entry& b) {
                         if (a.position[axis] != b.position[axis]) return a.position[axis] < b.position[axis];
                         return a.tile != b.tile ? a.tile < b.tile : a.index < b.index;
                     });
    build(first, middle, depth + 1);
    nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
    build(middle, last, depth + 1);
}

/// Notes a landing at every part that it may light.
void SplatTree::assign(std::uint32_t node, const SplatQuery& query, float reach, std::uint32_t index,
                       std::vector<std::vector<std::uint32_t>>& of_part) const {
    const Node& n = nodes_[node];
    if (!touches(n.low, n.high, query, reach)) return;
    if (part_of_node_[node] >= 0) {
        of_part[static_cast<std::size_t>(part_of_node_[node])].push_back(index);
        return;
    }
    assign(node + 1, query, reach, index, of_part);
    assign(n.right, query, reach, index, of_part);
}

/// The points of a part, and what has come to them.
class SplatTree::Part {
  public:
    Part(const SplatTree& tree, std::size_t part, const PosedScene& scene, SplatVisibility visibility)
        : tree_(tree), scene_(scene), visibility_(visibility), root_(tree.parts_[part]) {
        first_leaf_ = tree.nodes_[root_].leaf;
        const std::size_t end =
            part + 1 < tree.parts_.size() ? tree.nodes_[tree.parts_[part + 1]].leaf : tree.leaves_.size();
        sums_.resize(end - first_leaf_);
    }

    void spread(const Landing& landing, const Footprint& footprint, std::vector<CausticLight>& light) {
        const SplatQuery query = query_of(landing, footprint);
        const float reach = reach_of(landing, footprint);
        open_.assign(1, root_);
        while (!open_.empty()) {
            const std::uint32_t index = open_.back();
            open_.pop_back();
            const Node& n = tree_.nodes_[index];
            if (!touches(n.low, n.high, query, reach)) continue;
            if (n.right == 0) {
                spread_over(n, landing, footprint, query, light);
            } else {
                open_.push_back(n.right);
                open_.push_back(index + 1);
            }
        }
    }

    /// Hands over what has come.
    void take(std::vector<CausticLight>& light, SplatCounts& counts) const {
        take_node(root_, light);
        counts.pairs += counts_.pairs;
        counts.doubtful += counts_.doubtful;
    }

  private:
    void spread_over(const Node& leaf, const Landing& landing, const Footprint& footprint, const SplatQuery& query,
                     std::vector<CausticLight>& light) {
        SplatShares weights;
        const std::uint32_t states = weigh(tree_.leaves_[leaf.leaf], query, weights);
        if (states == 0) return;
        if ((states & 2u) != 0 && visibility_ == SplatVisibility::by_rays) close(leaf, landing, footprint, weights);
        for (std::uint32_t i = 0; i < leaf.last - leaf.first; ++i) {
            if (weights.state[i] == 0) continue;
            ++counts_.pairs;
            const SurfacePoint& p = tree_.points_[leaf.first + i].point->point;
            if (!p.bsdf.has_glossy()) continue;
            const glm::vec3 sent = landing.flux * weights.weight[i] *
                                   evaluate(widened(p.bsdf, footprint.blur), p.shading_normal, p.outgoing,
                                            -direction_at(landing, footprint, p.position));
            const float luminance = core::luminance(sent);
            light[leaf.first + i].glossy += sent;
            light[leaf.first + i].glossy_squares += luminance * luminance;
        }
        renderer::add(weights, landing.flux, sums_[leaf.leaf - first_leaf_]);
    }

    /// Takes the light from points behind something: sixteen parallel rays at once; what threw the light is no
    /// obstacle.
    void close(const Node& leaf, const Landing& landing, const Footprint& footprint, SplatShares& weights) {
        ShadowPacket packet;
        packet.bodies = Bodies::block;
        alignas(64) float times[16] = {};
        if (landing.time != scene::middle_time) packet.times = times;
        const float far = std::min(landing.length, doubt_reach * footprint.widest);
        for (std::uint32_t i = 0; i < leaf.last - leaf.first; ++i) {
            if (weights.state[i] != 2u) continue;
            const glm::vec3 origin = shadow_origin(tree_.points_[leaf.first + i].point->point);
            packet.origin_x[i] = origin.x;
            packet.origin_y[i] = origin.y;
            packet.origin_z[i] = origin.z;
            packet.direction_x[i] = -landing.direction.x;
            packet.direction_y[i] = -landing.direction.y;
            packet.direction_z[i] = -landing.direction.z;
            packet.far[i] = far;
            times[i] = time_at(scene_, landing, *tree_.points_[leaf.first + i].point);
            packet.active |= 1u << i;
            ++counts_.doubtful;
        }
        std::uint32_t blocked = scene_.tracer().occluded(packet, nullptr);
        for (std::uint32_t i = 0; blocked != 0; ++i, blocked >>= 1)
            if ((blocked & 1u) != 0 && !is_open(scene_, landing, *tree_.points_[leaf.first + i].point, far)) {
                weights.weight[i] = 0.0f;
                weights.state[i] = 0;
            }
    }

    void take_node(std::uint32_t index, std::vector<CausticLight>& light) const {
        const Node& n = tree_.nodes_[index];
        if (n.right != 0) {
            take_node(index + 1, light);
            take_node(n.right, light);
            return;
        }
        const SplatSums& sums = sums_[n.leaf - first_leaf_];
        for (std::uint32_t i = 0; i < n.last - n.first; ++i) {
            const glm::vec3 irradiance(sums.red[i], sums.green[i], sums.blue[i]);
            CausticLight& to = light[n.first + i];
            if (!tree_.points_[n.first + i].point->point.bsdf.has_glossy())
                to.irradiance += irradiance * lobe::inverse_pi;
            to.sum += core::luminance(irradiance);
            to.squares += sums.squares[i];
        }
    }

    const SplatTree& tree_;
    const PosedScene& scene_;
    SplatVisibility visibility_;
    std::uint32_t root_ = 0, first_leaf_ = 0;
    std::vector<SplatSums> sums_;
    std::vector<std::uint32_t> open_;
    SplatCounts counts_;
};

void SplatTree::add(const PosedScene& posed_scene, std::span<const Landing> landings,
                    std::span<const Footprint> footprints, SplatVisibility visibility, std::vector<CausticLight>& light,
                    SplatCounts& counts) const {
    light.resize(points_.size());
    if (points_.empty()) return;
    std::vector<std::vector<std::uint32_t>> of_part(parts_.size());
    for (std::uint32_t i = 0; i < landings.size(); ++i)
        if (footprints[i].widest > 0.0f)
            assign(0, query_of(landings[i], footprints[i]), reach_of(landings[i], footprints[i]), i, of_part);
    std::vector<SplatCounts> part_counts(parts_.size());
    parallel::for_each(parts_.size(), [&](std::size_t part) {
        if (of_part[part].empty()) return;
        Part lit(*this, part, posed_scene, visibility);
        for (const std::uint32_t i : of_part[part]) lit.spread(landings[i], footprints[i], light);
        lit.take(light, part_counts[part]);
    });
    for (const SplatCounts& c : part_counts) {
        counts.pairs += c.pairs;
        counts.doubtful += c.doubtful;
    }
}

}  // namespace render2mpeg::renderer
