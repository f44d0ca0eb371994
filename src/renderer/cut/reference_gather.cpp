#include "renderer/cut/reference_gather.h"

#include <algorithm>

#include "renderer/base/flush_denormals.h"
#include "renderer/base/isa_clones.h"
#include "renderer/cut/bias_compensation.h"
#include "renderer/cut/cut_sums.h"
#include "renderer/cut/gatherer.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// A ray from the point, which all lanes are, to each light that shines and could reach it.
RENDER2MPEG_CLONES
void aim_at_each(const GatherLanes& lanes, LightType type, const LightPacket& lights, const LightLanes& unit,
                 ShadowPacket& packet) {
    aim<Aimed::at_each>(lanes.origin, type, lights.position.x, lights.position.y, lights.position.z, packet);
    std::uint32_t active = 0;
    for (int i = 0; i < lane_count; ++i) {
        const float shines = lights.intensity.x[i] + lights.intensity.y[i] + lights.intensity.z[i];
        active |= unit.diffuse[i] > 0.0f && shines > 0.0f ? 1u << i : 0u;
    }
    packet.active = active;
}

RENDER2MPEG_CLONES
void darken(const GatherLanes& lanes, std::uint32_t lit, LightLanes& unit) {
    for (int i = 0; i < lane_count; ++i) {
        const float visible = (lit >> i & 1u) != 0 ? 1.0f : 0.0f;
        unit.diffuse[i] *= visible;
        if (!lanes.glossy) continue;
        unit.f0[i] *= visible;
        unit.schlick[i] *= visible;
    }
}

glm::vec3 total(const RgbLanes& lanes) {
    glm::vec3 sum(0);
    for (int i = 0; i < lane_count; ++i) sum += lanes.at(i);
    return sum;
}

void set_first(RgbLanes& lanes, glm::vec3 v) {
    lanes.r[0] = v.x;
    lanes.g[0] = v.y;
    lanes.b[0] = v.z;
}

}  // namespace

void gather_all(const LightTrees& light_trees, const RayTracer& tracer, const GatherPoint& point, GatheredLight& out) {
    const FlushDenormals flushed;
    const GatherPoint* copies[lane_count];
    std::fill(std::begin(copies), std::end(copies), &point);
    GatherLanes lanes, alone;
    fill(lanes, copies);
    GatheredLight exact;
    Gatherer(light_trees, tracer).gather_exact(lanes, Shadow::sharp, nullptr, {}, exact);
    GatheredLight lamps;
    Gatherer(light_trees, tracer).gather_exact(lanes, Shadow::smooth, nullptr, {}, lamps);
    fill(alone, std::span(copies).first(1));

    CutSums sums(lanes);
    LightPacket lights;
    LightLanes unit;
    ShadowPacket packet;
    glm::vec3 passes[lane_count];
    for (int t = 0; t < LightTrees::tree_count; ++t) {
        const LightTree& tree = light_trees.trees[t];
        for (std::size_t first = 0; first < tree.lights.size(); first += lane_count) {
            const std::size_t count = std::min<std::size_t>(lane_count, tree.lights.size() - first);
            fill_lights(lights, tree, first, count);
            evaluate_lights(lanes, tree.type, lights, light_trees.clamp(t), unit);
            aim_at_each(lanes, tree.type, lights, unit, packet);
            ShadowTimes times;
            packet.times = nullptr;
            if (lanes.timed && t != LightTrees::dynamic_tree) {
                for (int i = 0; i < lane_count; ++i)
                    times.set_for(lanes, i, lights.position.x[i], lights.position.y[i], lights.position.z[i]);
                packet.times = times.at;
            }
            if (packet.active == 0) continue;
            packet.bodies = light_trees.bodies_before(t);
            std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
            const std::uint32_t blocked = tracer.occluded(packet, light_trees.translucent ? passes : nullptr);
            if (light_trees.air != nullptr) dim(*light_trees.air, packet, packet.active & ~blocked, passes);
            darken(lanes, packet.active & ~blocked, unit);
            if (light_trees.translucent)
                for (int i = 0; i < lane_count; ++i) {
                    lights.intensity.x[i] *= passes[i].x;
                    lights.intensity.y[i] *= passes[i].y;
                    lights.intensity.z[i] *= passes[i].z;
                }
            sums.add(unit_light(lanes, unit), lights.intensity, LightTrees::is_direct(t));
        }
    }
    sums.store(out);
    set_first(out.direct, exact.direct.at(0) + lamps.direct.at(0) + total(out.direct));
    set_first(out.indirect, exact.indirect.at(0) + total(out.indirect));
    compensate_clamping_bias(light_trees, tracer, alone, out);
    if (!lanes.glossy) return;
    set_first(out.f0, exact.f0.at(0) + lamps.f0.at(0) + total(out.f0));
    set_first(out.schlick, exact.schlick.at(0) + lamps.schlick.at(0) + total(out.schlick));
}

}  // namespace render2mpeg::renderer
