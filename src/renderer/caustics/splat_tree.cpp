// After [Herzog2007, 4.2]: light falls off with the distance from the photon's way, and each receiver has its own
// cosine. Changed: ellipses (caustic_photons.h); in place of frustums in a k-d tree of nodes that know their normals,
// boxes of points, which photons are sorted into first, so that threads need not share what they add to; and visibility
// [HerzogThesis, 5] by exact rays for the few pairs that need one.
#include "renderer/caustics/splat_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Points of a leaf. chosen: 16, of 8 to 64.
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

bool touches(glm::vec3 low, glm::vec3 high, glm::vec3 centre, float radius) {
    const glm::vec3 away = glm::max(glm::max(low - centre, centre - high), glm::vec3{0.0f});
    return glm::dot(away, away) <= radius * radius;
}

/// Whether light that goes the landing's way meets the point: nothing but what threw it lies just before.
bool is_open(const PosedScene& scene, const Landing& landing, const GatherPoint& g, float widest) {
    const float far = std::min(landing.length, doubt_reach * widest);
    const Hit hit = scene.tracer().nearest(shadow_origin(g.point), -landing.direction, far);
    return !hit.found() || hit.address.object == landing.caster;
}

}  // namespace

Footprint footprint_of(const Landing& landing, float pixel, float limit) {
    // A disc that shines evenly has a quarter of its radius squared as variance, the kernel a sixth.
    constexpr float of_disc = 1.5f;
    Footprint f;
    core::make_frame(landing.direction, f.across[0], f.across[1]);
    glm::mat2 k(pixel * pixel + landing.spread * landing.spread);
    const auto add = [&](glm::vec3 edge, float scale) {
        const glm::vec2 v = scale * glm::vec2(glm::dot(edge, f.across[0]), glm::dot(edge, f.across[1]));
        k += glm::outerProduct(v, v);
    };
    for (const glm::vec3& edge : landing.cell) add(edge, 1.0f);
    for (const glm::vec3& edge : landing.lamp) add(edge, std::sqrt(of_disc));
    const float middle = 0.5f * (k[0][0] + k[1][1]), half = 0.5f * (k[0][0] - k[1][1]);
    const float offset = std::sqrt(half * half + k[0][1] * k[0][1]);
    const float largest = middle + offset;
    float determinant = k[0][0] * k[1][1] - k[0][1] * k[0][1];
    if (!std::isfinite(largest) || !(largest > 0.0f)) return f;
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

SplatTree::SplatTree(const Seen& seen) {
    std::size_t count = 0;
    for (const GatherTile& tile : seen.tiles) count += tile.size();
    points_.reserve(count);
    for (std::uint32_t t = 0; t < seen.tiles.size(); ++t)
        for (std::uint32_t i = 0; i < seen.tiles[t].size(); ++i)
            points_.push_back({seen.tiles[t][i].point.position, &seen.tiles[t][i], t, i});
    if (!points_.empty()) build(0, static_cast<std::uint32_t>(points_.size()), 0);
}

void SplatTree::build(std::uint32_t first, std::uint32_t last, int depth) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{points_[first].position, points_[first].position, first, last, 0};
    for (std::uint32_t i = first; i < last; ++i) {
        node.low = glm::min(node.low, points_[i].position);
        node.high = glm::max(node.high, points_[i].position);
    }
    nodes_.push_back(node);
    const bool leaf = last - first <= leaf_size;
    part_of_node_.push_back(-1);
    if (depth == part_depth || (leaf && depth < part_depth)) {
        part_of_node_[index] = static_cast<std::int32_t>(parts_.size());
        parts_.push_back(index);
    }
    if (leaf) return;
    const glm::vec3 size = node.high - node.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
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
void SplatTree::assign(std::uint32_t node, const Landing& landing, const Footprint& footprint, std::uint32_t index,
                       std::vector<std::vector<std::uint32_t>>& of_part) const {
    const Node& n = nodes_[node];
    if (!touches(n.low, n.high, landing.position, reach_of(landing, footprint))) return;
    if (part_of_node_[node] >= 0) {
        of_part[static_cast<std::size_t>(part_of_node_[node])].push_back(index);
        return;
    }
    assign(node + 1, landing, footprint, index, of_part);
    assign(n.right, landing, footprint, index, of_part);
}

namespace {

/// Spreads one landing over points.
class Splat {
  public:
    Splat(const PosedScene& scene, const Landing& landing, const Footprint& footprint, SplatVisibility visibility,
          SplatCounts& counts)
        : scene_(scene),
          landing_(landing),
          footprint_(footprint),
          visibility_(visibility),
          counts_(counts),
          reach_(reach_of(landing, footprint)),
          along_(footprint.widest * reach_along) {}

    float reach() const { return reach_; }

    void light(const GatherPoint& g, CausticLight& light) const {
        const SurfacePoint& p = g.point;
        const glm::vec3 e = p.position - landing_.position;
        const glm::vec2 q(glm::dot(e, footprint_.across[0]), glm::dot(e, footprint_.across[1]));
        const float distance2 = glm::dot(q, footprint_.inverse * q);
        if (!(distance2 < 1.0f)) return;
        const float cosine = -glm::dot(landing_.direction, p.shading_normal);
        if (!(cosine > 0.0f) || !(glm::dot(landing_.direction, p.geometric_normal) < 0.0f)) return;
        const bool faces = glm::dot(p.geometric_normal, landing_.normal) > same_facing;
        const bool own = p.address.object == landing_.object && faces &&
                         std::abs(glm::dot(e, landing_.normal)) <= same_plane_share * footprint_.widest;
        if (!own && std::abs(glm::dot(e, landing_.direction)) > along_) return;
        ++counts_.pairs;
        if (!own && visibility_ == SplatVisibility::by_rays) {
            ++counts_.doubtful;
            if (!is_open(scene_, landing_, g, footprint_.widest)) return;
        }
        const glm::vec3 irradiance = landing_.flux * (footprint_.peak * (1.0f - distance2) * cosine);
        if (p.bsdf.has_glossy())
            light.glossy += irradiance * evaluate(p.bsdf, p.shading_normal, p.outgoing, -landing_.direction);
        else
            light.irradiance += irradiance * lobe::inverse_pi;
        const float luminance = core::luminance(irradiance);
        light.sum += luminance;
        light.squares += luminance * luminance;
    }

  private:
    const PosedScene& scene_;
    const Landing& landing_;
    const Footprint& footprint_;
    SplatVisibility visibility_;
    SplatCounts& counts_;
    float reach_, along_;
};

}  // namespace

void SplatTree::add(const PosedScene& posed_scene, std::span<const Landing> landings,
                    std::span<const Footprint> footprints, SplatVisibility visibility, std::vector<CausticLight>& light,
                    SplatCounts& counts) const {
    light.resize(points_.size());
    if (points_.empty()) return;
    std::vector<std::vector<std::uint32_t>> of_part(parts_.size());
    for (std::uint32_t i = 0; i < landings.size(); ++i)
        if (footprints[i].widest > 0.0f) assign(0, landings[i], footprints[i], i, of_part);
    std::vector<SplatCounts> part_counts(parts_.size());
    parallel::for_each(parts_.size(), [&](std::size_t part) {
        std::vector<std::uint32_t> open;
        for (const std::uint32_t i : of_part[part]) {
            const Splat splat(posed_scene, landings[i], footprints[i], visibility, part_counts[part]);
            open.assign(1, parts_[part]);
            while (!open.empty()) {
                const std::uint32_t index = open.back();
                open.pop_back();
                const Node& n = nodes_[index];
                if (!touches(n.low, n.high, landings[i].position, splat.reach())) continue;
                if (n.right != 0) {
                    open.push_back(n.right);
                    open.push_back(index + 1);
                    continue;
                }
                for (std::uint32_t k = n.first; k < n.last; ++k) splat.light(*points_[k].point, light[k]);
            }
        }
    });
    for (const SplatCounts& c : part_counts) {
        counts.pairs += c.pairs;
        counts.doubtful += c.doubtful;
    }
}

}  // namespace render2mpeg::renderer
