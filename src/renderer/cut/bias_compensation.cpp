// Bias compensation: lights on surfaces near a point are discs to it, not points. What the clamp takes of
// them is added
// (docs/model/clamping.md). [Render2MPEG, 6.5] finds it by short rays over the hemisphere; here the near lights are
// known, and their discs have form factors: no noise, and no more rays than one for each.
#include "renderer/cut/bias_compensation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Corners of the regular hexagon that stands for a disc of the same area lie this far out, in its radii:
/// pi r^2 = 3 sqrt(3) / 2 R^2.
constexpr int corners = 6;
constexpr float corner_radius = 1.0996361f;

/// Hexagons are this much wider than their discs, and as much dimmer, so that neighbours overlap: discs of their
/// own size leave gaps and bright dashes along edges. chosen: 1.75 of 1 to 2.5 (docs/measurements.md#lightcuts).
constexpr float overlap = 1.75f;

/// How far off a hexagon a surface may lie that counts as part of it, in radii of its disc: things are bent. chosen:
/// 0.25.
constexpr float probe_radii = 0.25f;

/// Least light that is compensated, as a share of that from a light which fills the view. chosen: 1e-5.
constexpr float least_share = 1e-5f;

/// A polygon as a point sees it: corners relative to the point. A plane cuts a convex one into at most one corner more.
struct Polygon {
    glm::vec3 corner[corners + 1];
    int count = 0;

    const glm::vec3& after(int k) const { return corner[k + 1 < count ? k + 1 : 0]; }
    /// Twice the area.
    float area2() const {
        glm::vec3 sum(0);
        for (int k = 1; k + 1 < count; ++k) sum += glm::cross(corner[k] - corner[0], corner[k + 1] - corner[0]);
        return glm::length(sum);
    }
    /// The part of it in front of a plane through the point.
    Polygon before(glm::vec3 normal) const {
        Polygon part;
        for (int k = 0; k < count; ++k) {
            const glm::vec3 a = corner[k], b = after(k);
            const float above = glm::dot(a, normal), next = glm::dot(b, normal);
            if (above > 0.0f && part.count <= corners) part.corner[part.count++] = a;
            if ((above > 0.0f) != (next > 0.0f) && part.count <= corners)
                part.corner[part.count++] = a + (b - a) * (above / (above - next));
        }
        return part;
    }
    /// Integral of cosine over solid angle, by its edges [Lambert1760].
    float projected(glm::vec3 normal) const {
        glm::vec3 to[corners + 1];
        for (int k = 0; k < count; ++k) to[k] = core::normalize_or(corner[k], normal);
        float sum = 0;
        for (int k = 0; k < count; ++k) {
            const glm::vec3& next = to[k + 1 < count ? k + 1 : 0];
            const glm::vec3 across = glm::cross(to[k], next);
            const float sine = glm::length(across), angle = std::atan2(sine, glm::dot(to[k], next));
            sum += core::divide_or(angle, sine, 1.0f) * glm::dot(across, normal);
        }
        return std::abs(0.5f * sum);
    }
};

core::Box box_of(const GatherLanes& lanes) {
    core::Box box;
    for (int i = 0; i < lanes.count; ++i) box.hold(lanes.position.at(i));
    return box;
}

/// Squared distance between boxes.
float distance2(const core::Box& box, glm::vec3 middle, glm::vec3 half) {
    const glm::vec3 gap = glm::max(glm::max(middle - half - box.high, box.low - middle - half), glm::vec3(0));
    return glm::dot(gap, gap);
}

/// A light's disc as a polygon.
class Hexagon {
  public:
    explicit Hexagon(const TreeLight& light) : light_(light) {
        glm::vec3 tangent, bitangent;
        core::make_frame(light.normal(), tangent, bitangent);
        const float radius = overlap * corner_radius * std::sqrt(light.disc2);
        for (int k = 0; k < corners; ++k) {
            const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 3;
            rim_[k] = light.position + radius * (std::cos(angle) * tangent + std::sin(angle) * bitangent);
        }
    }

    DiscLight seen_by(const GatherLanes& lanes, int i) const {
        const glm::vec3 at = lanes.position.at(i), way = light_.position - at;
        const float radii2 = core::divide_or(glm::dot(way, way), light_.disc2, far_radii * far_radii);
        if (!(radii2 < far_radii * far_radii)) return {};
        const glm::vec3 normal = lanes.normal.axis.at(i);
        Polygon whole;
        for (const glm::vec3& corner : rim_) whole.corner[whole.count++] = corner - at;
        const Polygon part = whole.before(normal);
        const float area2 = part.area2();
        if (part.count < 3 || !(area2 > 0.0f)) return {};
        const float share = std::clamp((far_radii - std::sqrt(radii2)) / (far_radii - near_radii), 0.0f, 1.0f);
        return {2.0f * part.projected(normal) / area2, share};
    }

  private:
    const TreeLight& light_;
    glm::vec3 rim_[corners];
};

/// By how much each lane's irradiance of unit intensity falls short of the disc's, without visibility; whether any
/// lane's does.
bool find_deficit(const GatherLanes& lanes, const TreeLight& light, GeometryClamp clamp, Lanes& deficit) {
    LightLanes point;
    evaluate_light(lanes, LightType::oriented, light, nullptr, clamp, point);
    // Most lights near a point lie in its own plane, but for rounding.
    const float least = least_share / light.disc2;
    std::uint32_t lit = 0;
    for (int i = 0; i < lanes.count; ++i) lit |= point.diffuse[i] > least ? 1u << i : 0u;
    if (lit == 0) return false;
    const auto discs = disc_light(lanes, lit, light);
    for (std::size_t i = 0; i < lane_count; ++i)
        deficit[i] = (lit >> i & 1u) != 0 ? discs[i].share * (discs[i].irradiance - point.diffuse[i]) : 0.0f;
    return true;
}

/// Transmittance from the light to each lane with a deficit; traces a ray for each of those.
void see(const GatherLanes& lanes, const TreeLight& light, const RayTracer& tracer, Lanes& deficit, glm::vec3* passes,
         GatheredLight& out) {
    ShadowPacket packet;
    aim(lanes, LightType::oriented, light, packet);
    for (int i = 0; i < lane_count; ++i) {
        passes[i] = glm::vec3(1);
        packet.active |= deficit[i] != 0.0f ? 1u << i : 0u;
    }
    if (packet.active == 0) return;
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
    const std::uint32_t blocked = tracer.occluded(packet, passes);
    for (int i = 0; i < lane_count; ++i)
        if ((blocked >> i & 1u) != 0) deficit[i] = 0.0f;
}

/// Forgets lanes for which no surface lies where a part of the hexagon would light them from: halfway between the light
/// and the place of its plane that is nearest to the lane. Discs on slender things reach over their edges,
/// those in a gap between a thing and the wall behind it along the wall. What lies as near to the lane's own
/// surface is that, and does not count.
void keep_to_surfaces(const GatherLanes& lanes, const TreeLight& light, const RayTracer& tracer, Lanes& deficit,
                      GatheredLight& out) {
    const float radius = std::sqrt(light.disc2), widest = overlap * radius;
    const glm::vec3 facing = light.normal();
    ShadowPacket packet;
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec3 at = lanes.position.at(i), way = at - light.position;
        const glm::vec3 aside = way - glm::dot(way, facing) * facing;
        const float far = glm::length(aside);
        const glm::vec3 middle = light.position + 0.5f * std::min(1.0f, core::divide_or(widest, far, 1.0f)) * aside;
        const glm::vec3 own{lanes.geometric.x[i], lanes.geometric.y[i], lanes.geometric.z[i]};
        const float reach = std::min(probe_radii * radius, 0.5f * std::abs(glm::dot(middle - at, own)));
        const glm::vec3 from = middle + reach * facing;
        packet.origin_x[i] = from.x;
        packet.origin_y[i] = from.y;
        packet.origin_z[i] = from.z;
        packet.direction_x[i] = -facing.x;
        packet.direction_y[i] = -facing.y;
        packet.direction_z[i] = -facing.z;
        packet.far[i] = 2.0f * reach;
        packet.active |= deficit[i] != 0.0f ? 1u << i : 0u;
    }
    if (packet.active == 0) return;
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
    const std::uint32_t met = tracer.occluded(packet, nullptr);
    for (int i = 0; i < lane_count; ++i)
        if ((met >> i & 1u) == 0) deficit[i] = 0.0f;
}

void compensate(const TreeLight& light, const LightTrees& light_trees, const GatherLanes& lanes,
                const RayTracer& tracer, GatheredLight& out) {
    Lanes deficit;
    if (!find_deficit(lanes, light, light_trees.point_clamp, deficit)) return;
    glm::vec3 passes[lane_count];
    see(lanes, light, tracer, deficit, passes, out);
    keep_to_surfaces(lanes, light, tracer, deficit, out);
    for (int i = 0; i < lanes.count; ++i) {
        if (deficit[i] == 0.0f) continue;
        const glm::vec3 light_there = deficit[i] * light.intensity * passes[i];
        out.indirect.r[i] += light_there.x;
        out.indirect.g[i] += light_there.y;
        out.indirect.b[i] += light_there.z;
        const float luminance = lanes.diffuse_weight.x[i] * light_there.x + lanes.diffuse_weight.y[i] * light_there.y +
                                lanes.diffuse_weight.z[i] * light_there.z;
        out.clamped[i] = std::max(out.clamped[i] - std::max(luminance, 0.0f), 0.0f);
    }
}

}  // namespace

std::array<DiscLight, lane_count> disc_light(const GatherLanes& lanes, std::uint32_t wanted, const TreeLight& light) {
    const Hexagon hexagon(light);
    std::array<DiscLight, lane_count> discs{};
    for (std::size_t i = 0; i < lane_count; ++i)
        if ((wanted >> i & 1u) != 0) discs[i] = hexagon.seen_by(lanes, static_cast<int>(i));
    return discs;
}

void compensate_clamping_bias(const LightTrees& light_trees, const RayTracer& tracer, const GatherLanes& lanes,
                              GatheredLight& out) {
    if (!(light_trees.point_clamp.scale < GeometryClamp::none().scale)) return;
    const core::Box box = box_of(lanes);
    // Discs are Lambert surfaces seen by Lambert surfaces: what a lobe takes of so little light is left out.
    GatherLanes plain = lanes;
    plain.glossy = false;
    std::vector<LightRef> left;
    for (const int t : {LightTrees::static_tree, LightTrees::dynamic_tree}) {
        const LightTree& tree = light_trees.trees[static_cast<std::size_t>(t)];
        if (tree.empty()) continue;
        left.assign(1, tree.root);
        while (!left.empty()) {
            const LightRef ref = left.back();
            left.pop_back();
            if (ref.is_leaf()) {
                const TreeLight& light = tree.lights[ref.index()];
                if (light.disc2 > 0.0f && core::luminance(light.intensity) > 0.0f &&
                    distance2(box, light.position, glm::vec3(0)) < far_radii * far_radii * light.disc2)
                    compensate(light, light_trees, plain, tracer, out);
                continue;
            }
            const LightNode& node = tree.nodes[ref.index()];
            const MiddleBox about = tree.box(ref.index());
            if (distance2(box, about.middle, about.half) >= far_radii * far_radii * node.disc2.largest()) continue;
            left.push_back(tree.child(ref.index(), 1));
            left.push_back(tree.child(ref.index(), 0));
        }
    }
}

}  // namespace render2mpeg::renderer
