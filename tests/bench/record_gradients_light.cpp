// Gradients of irradiance [Render2MPEG, 6.9, 6.22-6.26], the rotational one as the irradiance vector, which has the
// same first-order value and no sign to mistake: E(n') = E(n) + (n' - n) . sum of I V cos / d^2 w.
#include "record_gradients_light.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "renderer/base/lobe.h"
#include "renderer/cut/near_lights.h"
#include "renderer/cut/shadow_rays.h"
#include "renderer/tree/light_kernels.h"

namespace render2mpeg::bench {
namespace {

using renderer::lane_count;
using renderer::LightFamily;
using renderer::LightForest;
using renderer::LightRef;
using renderer::LightTree;

/// A light that reaches a place: `g` is the irradiance by unit intensity.
struct Arriving {
    LightFamily family;
    glm::dvec3 position;  ///< directional: unit direction to it
    glm::dvec3 normal;
    glm::dvec3 intensity;
    double disc2;  ///< of the disc that it stands for; 0 for none
    double g;
};

struct SlopeSums {
    glm::dvec3 light{0};
    glm::dmat3 by_place{0}, by_normal{0};
    double clearance = std::numeric_limits<double>::infinity();

    void add(const Arriving& l, glm::dvec3 place, glm::dvec3 normal);
    SlopedLight store() const {
        constexpr double scale = renderer::lobe::inverse_pi;
        return {glm::vec3(scale * light),
                glm::mat3(scale * by_place),
                glm::mat3(scale * by_normal),
                static_cast<float>(clearance),
                {}};
    }
};

void SlopeSums::add(const Arriving& l, glm::dvec3 place, glm::dvec3 normal) {
    light += l.g * l.intensity;
    if (l.family == LightFamily::directional) {
        by_normal += glm::outerProduct(l.intensity, l.position);
        return;
    }
    const glm::dvec3 q = l.position - place;
    const double r2 = glm::dot(q, q), a = glm::dot(normal, q);
    if (!(a > 0.0) || !(r2 > 0.0)) return;
    clearance = std::min(clearance, std::sqrt(r2));
    glm::dvec3 step, turn;
    if (l.family == LightFamily::oriented) {
        const double b = -glm::dot(l.normal, q), soft = r2 + l.disc2;
        // Where the clamp holds, light is what the clamp says, wherever the place lies.
        if (!(b > 0.0) || l.g < 0.999 * a * b / (r2 * r2)) return;
        step = (a * l.normal - b * normal + 2.0 * a * b * (1.0 / r2 + 1.0 / soft) * q) / (r2 * soft);
        turn = b / (r2 * soft) * q;
    } else {
        // Range and cone as constants.
        const double emits = l.g / a;  // over the cube of the distance
        step = -emits * normal + 3.0 * l.g / r2 * q;
        turn = emits * q;
    }
    by_place += glm::outerProduct(l.intensity, step);
    by_normal += glm::outerProduct(l.intensity, turn);
}

glm::vec3 at(const renderer::Vec3Lanes& v, int i) {
    return {v.x[i], v.y[i], v.z[i]};
}

struct Cluster {
    int tree;
    LightRef ref;
    std::uint32_t representative;
};

/// The clusters of the cut that an outline tells of.
std::vector<Cluster> clusters_of(const LightForest& forest, int set, const renderer::CutOutline& outline) {
    std::vector<Cluster> parts(2 * outline.splits.size()), roots(LightForest::tree_count);
    std::vector<bool> is_part(parts.size(), true), is_root(roots.size(), true);
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest.trees[static_cast<std::size_t>(t)];
        if (tree.empty())
            is_root[static_cast<std::size_t>(t)] = false;
        else
            roots[static_cast<std::size_t>(t)] = {t, tree.root, tree.representative(tree.root, set)};
    }
    for (std::size_t n = 0; n < outline.splits.size(); ++n) {
        const std::uint32_t part = outline.splits[n].part;
        const std::uint32_t root = part & ~renderer::CutOutline::of_root;
        const bool of_root = root != part;
        const Cluster whole = of_root ? roots[root] : parts[part];
        if (of_root)
            is_root[root] = false;
        else
            is_part[part] = false;
        const LightTree& tree = forest.trees[static_cast<std::size_t>(whole.tree)];
        for (const int side : {0, 1}) {
            const LightRef child = tree.child(whole.ref.index(), side);
            parts[2 * n + static_cast<std::size_t>(side)] = {whole.tree, child, tree.representative(child, set)};
        }
    }
    std::vector<Cluster> cut;
    for (std::size_t i = 0; i < roots.size(); ++i)
        if (is_root[i]) cut.push_back(roots[i]);
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (is_part[i]) cut.push_back(parts[i]);
    return cut;
}

/// What its geometry is summed over: the clusters two levels below.
std::vector<LightRef> grandchildren(const LightTree& tree, LightRef ref) {
    std::vector<LightRef> parts{ref};
    for (int level = 0; level < 2; ++level) {
        std::vector<LightRef> next;
        for (const LightRef part : parts) {
            if (part.is_leaf()) {
                next.push_back(part);
                continue;
            }
            for (const int side : {0, 1}) next.push_back(tree.child(part.index(), side));
        }
        parts = next;
    }
    return parts;
}

void add_cluster(const LightForest& forest, const renderer::RayTracer& tracer, const renderer::GatherLanes& lanes,
                 const Cluster& c, std::vector<SlopeSums>& sums) {
    const LightTree& tree = forest.trees[static_cast<std::size_t>(c.tree)];
    const renderer::TreeLight& own = tree.lights[c.representative];
    renderer::LightLanes unit;
    evaluate_light(lanes, tree.family, own, tree.spot(c.representative), forest.clamp(c.tree), unit);
    renderer::ShadowPacket packet;
    aim(lanes, tree.family, own, packet);
    packet.active = 0;
    for (int i = 0; i < lanes.count; ++i) packet.active |= unit.diffuse[i] > 0.0f ? 1u << i : 0u;
    glm::vec3 passes[lane_count];
    std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
    const std::uint32_t blocked =
        packet.active != 0 ? tracer.occluded(packet, forest.translucent ? passes : nullptr) : 0;
    for (const LightRef part : grandchildren(tree, c.ref)) {
        const std::uint32_t light = tree.representative(part, lanes.set);
        const renderer::TreeLight& l = tree.lights[light];
        evaluate_light(lanes, tree.family, l, tree.spot(light), forest.clamp(c.tree), unit);
        for (int i = 0; i < lanes.count; ++i) {
            if ((blocked >> i & 1u) != 0 || !(unit.diffuse[i] > 0.0f)) continue;
            // Below the horizon of whom the representative is nobody knows.
            const float known = (packet.active >> i & 1u) != 0 ? 1.0f : 0.5f;
            const Arriving arriving{tree.family, l.position,     l.normal(), known * passes[i] * tree.intensity(part),
                                    l.disc2,     unit.diffuse[i]};
            sums[static_cast<std::size_t>(i)].add(arriving, at(lanes.position, i), at(lanes.normal.axis, i));
        }
    }
}

}  // namespace

SlopedLight gather_sloped(const LightForest& forest, const renderer::RayTracer& tracer,
                          const renderer::GatherPoint& point, Unshadowed* unshadowed) {
    const renderer::GatherPoint* copies[lane_count];
    std::fill(std::begin(copies), std::end(copies), &point);
    renderer::GatherLanes lanes, alone;
    fill(lanes, copies);
    fill(alone, std::span(copies).first(1));
    SlopeSums sums;
    std::vector<bool> lit;
    if (unshadowed != nullptr) unshadowed->clear();
    renderer::LightPacket lights;
    renderer::LightLanes unit;
    renderer::ShadowPacket packet;
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest.trees[static_cast<std::size_t>(t)];
        for (std::size_t first = 0; first < tree.lights.size(); first += lane_count) {
            const std::size_t count = std::min<std::size_t>(lane_count, tree.lights.size() - first);
            fill_lights(lights, tree, first, count);
            evaluate_lights(lanes, tree.family, lights, forest.clamp(t), unit);
            renderer::aim<renderer::Aimed::at_each>(lanes, tree.family, lights.position.x, lights.position.y,
                                                    lights.position.z, packet);
            packet.active = 0;
            for (int i = 0; i < static_cast<int>(count); ++i) {
                const float sends = unit.diffuse[i] * core::luminance(at(lights.intensity, i));
                packet.active |= sends > 0.0f ? 1u << i : 0u;
                if (unshadowed != nullptr) unshadowed->push_back(sends);
            }
            glm::vec3 passes[lane_count];
            std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
            const std::uint32_t blocked =
                packet.active != 0 ? tracer.occluded(packet, forest.translucent ? passes : nullptr) : 0;
            for (int i = 0; i < static_cast<int>(count); ++i) {
                lit.push_back((packet.active & ~blocked & 1u << i) != 0);
                if (!lit.back()) continue;
                sums.add({tree.family, at(lights.position, i), at(lights.normal, i),
                          passes[i] * at(lights.intensity, i), lights.disc2[i], unit.diffuse[i]},
                         point.point.position, point.point.shading_normal);
            }
        }
    }
    SlopedLight result = sums.store();
    renderer::GatheredLight near{};
    put_back_near_light(forest, tracer, alone, near);
    result.light += renderer::lobe::inverse_pi * (near.direct.at(0) + near.indirect.at(0));
    result.lit.assign(lit.size() / 64 + 1, 0);
    for (std::size_t i = 0; i < lit.size(); ++i)
        if (lit[i]) result.lit[i / 64] |= std::uint64_t{1} << i % 64;
    return result;
}

std::vector<SlopedLight> gather_sloped(const LightForest& forest, const renderer::RayTracer& tracer,
                                       std::span<const renderer::GatherPoint* const> points, int set,
                                       const renderer::GroupTolerance& tolerance, const renderer::CutLimits& limits) {
    renderer::GatherLanes lanes;
    fill(lanes, points);
    lanes.set = set;
    renderer::Gatherer gatherer(forest, tracer);
    renderer::GatheredLight gathered;
    gatherer.gather(lanes, tolerance, limits, gathered);
    renderer::CutOutline outline;
    gatherer.outline(lanes, outline);
    std::vector<SlopeSums> sums(points.size());
    for (const Cluster& c : clusters_of(forest, set, outline)) add_cluster(forest, tracer, lanes, c, sums);
    std::vector<SlopedLight> result;
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.push_back(sums[i].store());
        const auto lane = static_cast<int>(i);
        result.back().light = renderer::lobe::inverse_pi * (gathered.direct.at(lane) + gathered.indirect.at(lane));
    }
    return result;
}

}  // namespace render2mpeg::bench
