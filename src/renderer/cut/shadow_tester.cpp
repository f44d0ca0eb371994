#include "renderer/cut/shadow_tester.h"

#include <algorithm>

#include "renderer/base/isa_clones.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Bit i: the light could reach lane i.
RENDER2MPEG_ALWAYS_INLINED std::uint32_t reached(const LightLanes& unit) {
    std::uint32_t lanes = 0;
    for (int i = 0; i < lane_count; ++i) lanes |= unit.diffuse[i] > 0.0f ? 1u << i : 0u;
    return lanes;
}

}  // namespace

LightContribution LightContribution::unknown_in(std::uint16_t lanes) {
    LightContribution contribution;
    contribution.lit = contribution.unknown = lanes;
    std::fill(&contribution.tint.passes[0][0], &contribution.tint.passes[0][0] + lane_count * 3, 1.0f);
    return contribution;
}

void ShadowTester::start(const GatherLanes& lanes) {
    lanes_ = &lanes;
    rays_ = 0;
}

void ShadowTester::choose_occluders() {
    occluders_.choose(*lanes_, tracer_.occluders());
    if (light_trees_.shadows == Shadows::hidden_by_dynamic) dynamic_objects_.choose(*lanes_, tracer_.dynamic_objects());
}

RENDER2MPEG_CLONES
void ShadowTester::trace(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp,
                         LightContribution& contribution) {
    const GatherLanes& lanes = *lanes_;
    evaluate_light(lanes, type, light, spot, clamp, contribution.unit);
    ShadowPacket packet;
    aim(lanes, type, light, packet);
    packet.active = reached(contribution.unit);
    contribution.is_blocked = false;
    if (packet.active == 0) return;
    std::uint32_t hidden = 0;
    if (light_trees_.translucent) {
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        hidden = blocked(packet, passes);
        for (int i = 0; i < lane_count; ++i)
            for (int k = 0; k < 3 && (packet.active >> i & 1u) != 0; ++k) contribution.tint.passes[i][k] = passes[i][k];
    } else {
        hidden = blocked(packet);
    }
    contribution.lit = static_cast<std::uint16_t>((contribution.lit | packet.active) & ~hidden);
    contribution.unknown = static_cast<std::uint16_t>(contribution.unknown & ~packet.active);
    contribution.is_blocked = (packet.active & ~hidden) == 0;
    if (hidden == 0) return;
    LightLanes& unit = contribution.unit;
    for (int i = 0; i < lane_count; ++i) {
        const float visible = (hidden >> i & 1u) != 0 ? 0.0f : 1.0f;
        unit.diffuse[i] *= visible;
        if (!lanes.glossy) continue;
        unit.f0[i] *= visible;
        unit.schlick[i] *= visible;
    }
}

void ShadowTester::trace_from_places(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp,
                                     LightContribution& contribution) {
    const GatherLanes& lanes = *lanes_;
    if (lanes.places == 1) {
        trace(type, light, spot, clamp, contribution);
        return;
    }
    LightLanes& unit = contribution.unit;
    evaluate_light(lanes, type, light, spot, clamp, unit);
    const std::uint32_t active = reached(unit);
    if (active == 0) return;
    int count[lane_count]{};
    glm::vec3 passed[lane_count]{};
    for (int place = 0; place < lanes.places; ++place) {
        ShadowPacket packet;
        aim<Aimed::at_one>(origins(lanes, place), type, &light.position.x, &light.position.y, &light.position.z,
                           packet);
        packet.active = active;
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        const std::uint32_t lit = active & ~blocked(packet, light_trees_.translucent ? passes : nullptr);
        for (int i = 0; i < lane_count; ++i) {
            if ((lit >> i & 1u) == 0) continue;
            ++count[i];
            passed[i] += passes[i];
        }
    }
    for (int i = 0; i < lane_count; ++i) {
        const float share = static_cast<float>(count[i]) / static_cast<float>(lanes.places);
        for (int c = 0; c < 3; ++c)
            contribution.tint.passes[i][c] = count[i] > 0 ? passed[i][c] / static_cast<float>(count[i]) : 1.0f;
        unit.diffuse[i] *= share;
        if (!lanes.glossy) continue;
        unit.f0[i] *= share;
        unit.schlick[i] *= share;
    }
}

std::uint32_t ShadowTester::blocked(const ShadowPacket& packet, glm::vec3* passes) {
    if (light_trees_.shadows != Shadows::hidden_by_dynamic) {
        count(packet.active);
        return light_trees_.shadows == Shadows::of_everything ? tracer_.occluded(packet, passes)
                                                              : tracer_.occluded_by_static(packet, nullptr);
    }
    // A dynamic object hides the light, and nothing static does.
    ShadowPacket rays = packet;
    rays.active &= dynamic_objects_.met(packet);
    if (rays.active == 0) return packet.active;
    count(rays.active);
    rays.active &= tracer_.occluded_by_dynamic(rays);
    if (rays.active == 0) return packet.active;
    count(rays.active);
    return packet.active & ~(rays.active & ~tracer_.occluded_by_static(rays, nullptr));
}

}  // namespace render2mpeg::renderer
