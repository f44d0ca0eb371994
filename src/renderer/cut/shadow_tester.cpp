#include "renderer/cut/shadow_tester.h"

#include <algorithm>
#include <bit>

#include "core/numeric.h"
#include "renderer/base/isa_clones.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Places of a pixel that all see a light, or none does, leave no edge between the others. chosen: 64, so that a sliver
/// of a hundredth of the pixel may be missed; with 16 one of a sixteenth, which a sun makes seen.
constexpr int enough_places = 64;

/// Rays from each place of a pixel over the time of the shutter, where a moving object may hide a light. chosen: 4,
/// which make 16 times with a pixel's four places, as many as samples of motion blur; not tuned.
constexpr int times_of_place = 4;

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

RENDER2MPEG_CLONES
void ShadowTester::trace(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp, Bodies bodies,
                         LightContribution& contribution, bool on_mover) {
    const GatherLanes& lanes = *lanes_;
    evaluate_light(lanes, type, light, spot, clamp, contribution.unit);
    ShadowPacket packet;
    aim(lanes, type, light, packet);
    ShadowTimes times;
    if (lanes.timed && !on_mover) {
        for (int i = 0; i < lane_count; ++i)
            times.set_for(lanes, i, light.position.x, light.position.y, light.position.z);
        packet.times = times.at;
    }
    packet.active = reached(contribution.unit);
    packet.bodies = bodies;
    if (packet.active == 0) return;
    const std::uint32_t reached_lanes = packet.active;
    if (lanes.at_one_place) packet.active &= ~packet.active + 1;
    const int asked = std::countr_zero(packet.active);
    std::uint32_t hidden = 0;
    if (light_trees_.translucent) {
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        hidden = blocked(packet, passes);
        if (lanes.at_one_place) std::fill(std::begin(passes), std::end(passes), glm::vec3(passes[asked]));
        // Of fog something is known of all lanes, and of layers and volumes of those that were asked.
        const std::uint32_t known = knows_all() || lanes.at_one_place ? 0xffffu : packet.active;
        for (int i = 0; i < lane_count; ++i)
            for (int k = 0; k < 3 && (known >> i & 1u) != 0; ++k) contribution.tint.passes[i][k] = passes[i][k];
    } else {
        hidden = blocked(packet);
    }
    if (lanes.at_one_place && hidden != 0) hidden = reached_lanes;
    contribution.lit = static_cast<std::uint16_t>((contribution.lit | reached_lanes) & ~hidden);
    contribution.unknown = static_cast<std::uint16_t>(contribution.unknown & ~reached_lanes);
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

/// Of the places that a lane's shadow rays leave: how many were asked, how many a light reaches, and its transmittance.
struct ShadowTester::PlaceCounts {
    int asked[lane_count]{}, lit[lane_count]{};
    glm::vec3 passed[lane_count]{};

    /// Whether all places see it undimmed, or none does.
    bool is_plain(int lane) const {
        return lit[lane] == 0 || (lit[lane] == asked[lane] && passed[lane] == glm::vec3(static_cast<float>(lit[lane])));
    }

    /// `times`: as many rays as the one stands for.
    void add(int lane, bool reached, glm::vec3 passes, int times = 1) {
        asked[lane] += times;
        if (!reached) return;
        lit[lane] += times;
        passed[lane] += static_cast<float>(times) * passes;
    }
};

/// Lanes whose rays to a light may meet moving objects while the shutter is open.
std::uint32_t ShadowTester::swept(const ShadowPacket& packet, std::uint32_t active) const {
    std::uint32_t lanes = 0;
    for (int i = 0; i < lane_count; ++i) {
        if ((active >> i & 1u) == 0 || lanes_->shadow_part[i] < 0.0f) continue;
        const glm::vec3 origin{packet.origin_x[i], packet.origin_y[i], packet.origin_z[i]},
            direction{packet.direction_x[i], packet.direction_y[i], packet.direction_z[i]};
        lanes |= tracer_.may_meet_dynamic(origin, direction, packet.far[i]) ? 1u << i : 0u;
    }
    return lanes;
}

void ShadowTester::trace_from_places(LightType type, const TreeLight& light, const Spot* spot, GeometryClamp clamp,
                                     LaneShadows* shadows, LightContribution& contribution) {
    const GatherLanes& lanes = *lanes_;
    if (lanes.places == 1 && !lanes.timed && shadows == nullptr) {
        trace(type, light, spot, clamp, light_trees_.bodies, contribution);
        return;
    }
    LightLanes& unit = contribution.unit;
    evaluate_light(lanes, type, light, spot, clamp, unit);
    const LaneShadows known = shadows != nullptr ? *shadows : LaneShadows();
    const std::uint32_t active = reached(unit) & ~known.known();
    if ((active | known.known()) == 0) return;
    PlaceCounts counts;
    for (int place = 0; active != 0 && place < lanes.places; ++place) {
        ShadowPacket packet;
        aim<Aimed::at_one>(origins(lanes, place), type, &light.position.x, &light.position.y, &light.position.z,
                           packet);
        packet.bodies = light_trees_.bodies;
        packet.active = 0;
        for (int i = 0; i < lane_count; ++i) packet.active |= place < lanes.own_places[i] ? active & 1u << i : 0u;
        trace_place(packet, place, counts);
    }
    for (int i = 0; i < lane_count; ++i)
        if (lanes.more_places[i] != nullptr && (active >> i & 1u) != 0)
            trace_further(type, light, *lanes.more_places[i], i, counts);
    for (int i = 0; i < lane_count; ++i) {
        const auto lit = static_cast<float>(counts.lit[i]);
        const float known_share = (known.lit >> i & 1u) != 0 ? 1.0f : 0.0f;
        const float share = core::divide_or(lit, static_cast<float>(counts.asked[i]), known_share);
        if (shadows != nullptr && counts.asked[i] > 0 && counts.is_plain(i)) shadows->set(i, share > 0.0f);
        for (int c = 0; c < 3; ++c) contribution.tint.passes[i][c] = core::divide_or(counts.passed[i][c], lit, 1.0f);
        unit.diffuse[i] *= share;
        if (!lanes.glossy) continue;
        unit.f0[i] *= share;
        unit.schlick[i] *= share;
    }
}

/// One ray of each lane, or some over the time of the shutter where a moving object may be in between.
void ShadowTester::trace_place(ShadowPacket& packet, int place, PlaceCounts& counts) {
    const GatherLanes& lanes = *lanes_;
    const std::uint32_t over_time = lanes.timed ? swept(packet, packet.active) : 0;
    for (int turn = 0; turn < (over_time != 0 ? times_of_place : 1); ++turn) {
        if (turn > 0) packet.active = over_time;
        ShadowTimes times;
        if (lanes.timed) {
            for (int i = 0; i < lane_count; ++i)
                times.set(lanes, i, place * times_of_place + turn, lanes.own_places[i] * times_of_place);
            packet.times = times.at;
        }
        glm::vec3 passes[lane_count];
        const std::uint32_t lit = reach(packet, passes);
        for (int i = 0; i < lane_count; ++i) {
            if ((packet.active >> i & 1u) == 0) continue;
            // A place that nothing moving hides is seen at all times.
            const bool at_all = lanes.timed && (over_time >> i & 1u) == 0;
            counts.add(i, (lit >> i & 1u) != 0, passes[i], at_all ? times_of_place : 1);
        }
    }
}

/// Of one lane; stops where `enough_places` say the same.
void ShadowTester::trace_further(LightType type, const TreeLight& light, const std::vector<glm::vec3>& places, int lane,
                                 PlaceCounts& counts) {
    const int rays = lanes_->timed ? times_of_place : 1;  ///< that each stands for
    for (std::size_t first = 0; first < places.size(); first += lane_count) {
        const std::size_t size = std::min<std::size_t>(lane_count, places.size() - first);
        Vec3Lanes from;
        for (std::size_t k = 0; k < lane_count; ++k) {
            const glm::vec3 place = places[first + std::min(k, size - 1)];
            from.x[k] = place.x;
            from.y[k] = place.y;
            from.z[k] = place.z;
        }
        ShadowPacket packet;
        aim<Aimed::at_one>(from, type, &light.position.x, &light.position.y, &light.position.z, packet);
        ShadowTimes times;
        if (lanes_->timed) {
            for (std::size_t k = 0; k < lane_count; ++k) times.at[k] = ShadowTimes::kth(*lanes_, lane, first + k);
            packet.times = times.at;
        }
        packet.bodies = light_trees_.bodies;
        packet.active = (1u << size) - 1u;
        glm::vec3 passes[lane_count];
        const std::uint32_t lit = reach(packet, passes);
        for (std::size_t k = 0; k < size; ++k) counts.add(lane, (lit >> k & 1u) != 0, passes[k], rays);
        if (counts.asked[lane] >= enough_places * rays &&
            (counts.lit[lane] == 0 || counts.lit[lane] == counts.asked[lane]))
            return;
    }
}

/// Bit i: ray i reaches the light; passes[i]: its transmittance, 1 where nothing is translucent.
std::uint32_t ShadowTester::reach(const ShadowPacket& packet, glm::vec3* passes) {
    std::fill(passes, passes + lane_count, glm::vec3(1));
    return packet.active & ~blocked(packet, light_trees_.translucent ? passes : nullptr);
}

std::uint32_t ShadowTester::blocked(const ShadowPacket& packet, glm::vec3* passes) {
    count(packet.active);
    const std::uint32_t blocked = tracer_.occluded(packet, passes);
    if (light_trees_.air != nullptr && passes != nullptr)
        dim(*light_trees_.air, packet, knows_all() ? 0xffffu : packet.active & ~blocked, passes);
    return blocked;
}

}  // namespace render2mpeg::renderer
