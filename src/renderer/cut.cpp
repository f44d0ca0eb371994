// Lightcuts [Walter2005, 4; Render2MPEG, algorithm 3] for groups of up to sixteen points. Changed: the points of a
// group share one cut, and with it one packet of shadow rays per refined cluster, but each keeps its own bounds,
// luminance and tolerance; the cut is refined until every point accepts every cluster. All trees share one heap, so
// that direct and indirect light are held against the pixel's total. A finished cut sums the geometry of each cluster
// over four lights of it, with the visibility of its one representative: geometry needs no rays.
#include "renderer/cut.h"

#include <algorithm>
#include <limits>

#include "core/color.h"
#include "renderer/cut_sums.h"
#include "renderer/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

/// Where a shadow ray ends, as a share of the way to its light: Embree's distance to the light's own surface errs, and
/// surfaces in planes through the origin have hardly any offset of their own. chosen: 1 - 2^-18; at 1 five of six
/// pixels of the Cornell box err by more than 2 % (grains of false shadow), at 1 - 2^-24 still many, from 1 - 2^-22 to
/// 1 - 2^-14 no pixel changes.
constexpr float ray_end = 1.0f - 0x1p-18f;

constexpr std::uint16_t all_lanes = 0xffff;

void fetch(const LightTree& tree, LightRef ref) {
    if (!ref.is_leaf()) {
        __builtin_prefetch(&tree.nodes[ref.index()]);
        return;
    }
    const auto* light = reinterpret_cast<const char*>(&tree.lights[ref.index()]);
    __builtin_prefetch(light);
    __builtin_prefetch(light + sizeof(TreeLight) - 1);
}

void clear_counts(GatheredLight& out) {
    out.direct_clusters = out.indirect_clusters = 0;
    out.capped = 0;
    out.shadow_rays = 0;
    std::fill(std::begin(out.error), std::end(out.error), 0.0f);
}

/// A ray from each lane that the light could reach towards it.
RENDER2MPEG_ALWAYS_INLINED void aim(const GatherLanes& lanes, LightFamily family, const TreeLight& light,
                                    const LightLanes& unit, ShadowPacket& packet) {
    const bool far_away = family == LightFamily::directional;
    const float keep = far_away ? 0.0f : 1.0f;
    const float far = far_away ? std::numeric_limits<float>::infinity() : ray_end;
    std::uint32_t active = 0;
    for (int i = 0; i < lane_count; ++i) {
        packet.origin_x[i] = lanes.origin.x[i];
        packet.origin_y[i] = lanes.origin.y[i];
        packet.origin_z[i] = lanes.origin.z[i];
        packet.direction_x[i] = light.position.x - keep * lanes.origin.x[i];
        packet.direction_y[i] = light.position.y - keep * lanes.origin.y[i];
        packet.direction_z[i] = light.position.z - keep * lanes.origin.z[i];
        packet.far[i] = far;
        active |= unit.diffuse[i] > 0.0f ? 1u << i : 0u;
    }
    packet.active = active;
}

}  // namespace

RENDER2MPEG_CLONES
void Gatherer::trace(const GatherLanes& lanes, LightFamily family, const TreeLight& light, GeometryClamp clamp,
                     Arrival& arrival, GatheredLight& out) {
    evaluate_light(lanes, family, light, clamp, arrival.unit);
    ShadowPacket packet;
    aim(lanes, family, light, arrival.unit, packet);
    arrival.is_blocked = false;
    if (packet.active == 0) return;
    std::uint32_t blocked = 0;
    if (forest_.translucent) {
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        blocked = tracer_.occluded(packet, passes);
        for (int i = 0; i < lane_count; ++i)
            for (int k = 0; k < 3 && (packet.active >> i & 1u) != 0; ++k) arrival.tint.passes[i][k] = passes[i][k];
    } else {
        blocked = tracer_.occluded(packet, nullptr);
    }
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
    arrival.lit = static_cast<std::uint16_t>((arrival.lit | packet.active) & ~blocked);
    arrival.unknown = static_cast<std::uint16_t>(arrival.unknown & ~packet.active);
    arrival.is_blocked = (packet.active & ~blocked) == 0;
    if (blocked == 0) return;
    for (int i = 0; i < lane_count; ++i) {
        const float visible = (blocked >> i & 1u) != 0 ? 0.0f : 1.0f;
        arrival.unit.diffuse[i] *= visible;
        if (!lanes.glossy) continue;
        arrival.unit.f0[i] *= visible;
        arrival.unit.schlick[i] *= visible;
    }
}

UnitLight Gatherer::unit_of(const GatherLanes& lanes, const Arrival& arrival) const {
    UnitLight unit = unit_light(lanes, arrival.unit);
    if (forest_.translucent) unit.passes = arrival.tint.passes;
    return unit;
}

void Gatherer::gather_exact(const GatherLanes& lanes, CutSums& sums, GatheredLight& out) {
    for (const ExactLight& exact : forest_.exact) {
        Arrival arrival;
        std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
        trace(lanes, exact.family, exact.light, forest_.direct_clamp, arrival, out);
        const UnitLight unit = unit_of(lanes, arrival);
        add_luminance(lanes, unit, exact.light.intensity, luminance_);
        sums.add(unit, exact.light.intensity, true);
        ++out.direct_clusters;
    }
}

void Gatherer::trace_slot(const GatherLanes& lanes, std::uint32_t index, Arrival& arrival, GatheredLight& out) {
    Slot& slot = slots_[index];
    const LightTree& tree = forest_.trees[slot.tree];
    slot.representative = tree.representative(slot.ref, lanes.set);
    slot.intensity = tree.intensity(slot.ref);
    if (slot.is_dark && hide(lanes, index)) {
        std::fill(std::begin(slot.diffuse), std::end(slot.diffuse), 0.0f);
        if (lanes.glossy) {
            std::fill(std::begin(lobes_[index].f0), std::end(lobes_[index].f0), 0.0f);
            std::fill(std::begin(lobes_[index].schlick), std::end(lobes_[index].schlick), 0.0f);
        }
        if (forest_.translucent) tints_[index] = arrival.tint;
        slot.any_clamped = false;
        return;
    }
    trace(lanes, tree.family, tree.lights[slot.representative], forest_.clamp(slot.tree), arrival, out);
    std::copy(std::begin(arrival.unit.diffuse), std::end(arrival.unit.diffuse), std::begin(slot.diffuse));
    slot.lit = arrival.lit;
    slot.unknown = arrival.unknown;
    slot.any_clamped = arrival.unit.any_clamped;
    slot.is_dark = arrival.is_blocked;
    if (lanes.glossy) {
        std::copy(std::begin(arrival.unit.f0), std::end(arrival.unit.f0), std::begin(lobes_[index].f0));
        std::copy(std::begin(arrival.unit.schlick), std::end(arrival.unit.schlick), std::begin(lobes_[index].schlick));
    }
    if (forest_.translucent) tints_[index] = arrival.tint;
}

void Gatherer::start_cut(const GatherLanes& lanes, GatheredLight& out) {
    slots_.clear();
    lobes_.clear();
    tints_.clear();
    heap_.clear();
    settled_.clear();
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest_.trees[t];
        if (tree.empty()) continue;
        const std::uint32_t index = add_slot(lanes, t, tree.root);
        Arrival arrival;
        arrival.lit = arrival.unknown = all_lanes;
        std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
        trace_slot(lanes, index, arrival, out);
        add_luminance(lanes, unit_of(index), slots_[index].intensity, luminance_);
    }
    rule_.observe(luminance_);
    for (std::uint32_t i = 0; i < slots_.size(); ++i) push(lanes, i);
}

/// Whether nothing below a slot's node can be seen from any lane; then it counts as dark for all of them.
bool Gatherer::hide(const GatherLanes& lanes, std::uint32_t index) {
    Slot& slot = slots_[index];
    if (slot.is_tested || slot.shields == 0) return slot.is_hidden;
    slot.is_tested = true;
    const LightTree& tree = forest_.trees[slot.tree];
    const bool leaf = slot.ref.is_leaf();
    const glm::vec3 middle = leaf ? tree.lights[slot.ref.index()].position : tree.nodes[slot.ref.index()].middle;
    const glm::vec3 half = leaf ? glm::vec3(0) : tree.nodes[slot.ref.index()].half;
    slot.is_hidden = shields_.hide(lanes, tree.family, middle, half, slot.shields);
    if (slot.is_hidden) slot.lit = slot.unknown = 0;
    return slot.is_hidden;
}

std::uint32_t Gatherer::add_slot(const GatherLanes& lanes, int tree, LightRef ref) {
    const auto index = static_cast<std::uint32_t>(slots_.size());
    Slot& slot = slots_.emplace_back();
    slot.tree = static_cast<std::uint8_t>(tree);
    slot.ref = ref;
    if (lanes.glossy) lobes_.emplace_back();
    if (forest_.translucent) tints_.emplace_back();
    return index;
}

/// Has the memory ready, while rays are traced, that the next split will most likely want.
void Gatherer::fetch_next() const {
    if (heap_.empty()) return;
    const Slot& next = slots_[heap_.front().slot];
    const LightTree& tree = forest_.trees[next.tree];
    for (const LightRef child : tree.nodes[next.ref.index()].child) fetch(tree, child);
}

RENDER2MPEG_CLONES
void Gatherer::split(const GatherLanes& lanes, std::uint32_t index, GatheredLight& out) {
    const LightTree& tree = forest_.trees[slots_[index].tree];
    const LightRef parent = slots_[index].ref;
    const LightNode& node = tree.nodes[parent.index()];
    // The child that holds the representative keeps its rays; only the other one, adopted, is traced.
    const bool first_keeps = tree.first_represents(parent, lanes.set);
    const LightRef kept = node.child[first_keeps ? 0 : 1], adopted = node.child[first_keeps ? 1 : 0];
    const std::uint32_t added = add_slot(lanes, slots_[index].tree, adopted);
    slots_[added].is_dark = slots_[index].is_dark;
    slots_[added].shields = slots_[index].shields;

    Arrival arrival;
    arrival.lit = slots_[index].lit;
    arrival.unknown = slots_[index].unknown;
    if (forest_.translucent) arrival.tint = tints_[index];
    fetch_next();
    trace_slot(lanes, added, arrival, out);

    Slot& old = slots_[index];
    const glm::vec3& rest = tree.intensity(kept);
    const glm::vec3 change{rest.x - old.intensity.x, rest.y - old.intensity.y, rest.z - old.intensity.z};
    old.ref = kept;
    old.is_tested = false;
    old.intensity = rest;
    add_luminance(lanes, unit_of(index), change, luminance_);
    add_luminance(lanes, unit_of(added), slots_[added].intensity, luminance_);
    rule_.observe(luminance_);
    push(lanes, index);
    push(lanes, added);
}

Gatherer::Parts Gatherer::parts_of(const GatherLanes& lanes, const Slot& slot) const {
    Parts parts;
    if (slot.ref.is_leaf() || slot.lit == 0) return parts;
    const LightTree& tree = forest_.trees[slot.tree];
    const auto take = [&](LightRef part) {
        parts.light[parts.count] = tree.representative(part, lanes.set);
        parts.intensity[parts.count] = tree.intensity(part);
        fetch(tree, LightRef::leaf(parts.light[parts.count++]));
    };
    // Of the children those that are lights stay as they are.
    for (const LightRef child : tree.nodes[slot.ref.index()].child) {
        if (child.is_leaf()) {
            take(child);
            continue;
        }
        for (const LightRef part : tree.nodes[child.index()].child) take(part);
    }
    return parts;
}

RENDER2MPEG_CLONES
void Gatherer::sum_finely(const GatherLanes& lanes, std::uint32_t index, const Parts& parts, CutSums& sums) const {
    const Slot& slot = slots_[index];
    const LightTree& tree = forest_.trees[slot.tree];
    const bool direct = LightForest::is_direct(slot.tree);
    alignas(64) Lanes visible;
    for (int i = 0; i < lane_count; ++i) {
        const float lit = (slot.unknown >> i & 1) != 0 ? 0.5f : 1.0f;
        visible[i] = (slot.lit >> i & 1) != 0 ? lit : 0.0f;
    }
    const UnitLight own = unit_of(index);
    for (int p = 0; p < parts.count; ++p) {
        if (parts.light[p] == slot.representative) {
            sums.add(own, parts.intensity[p], direct);
            continue;
        }
        LightLanes unit;
        evaluate_light(lanes, tree.family, tree.lights[parts.light[p]], forest_.clamp(slot.tree), unit);
        for (int i = 0; i < lane_count; ++i) {
            unit.diffuse[i] *= visible[i];
            if (!lanes.glossy) continue;
            unit.f0[i] *= visible[i];
            unit.schlick[i] *= visible[i];
        }
        sums.add({unit.diffuse, own.f0 != nullptr ? &unit.f0 : nullptr, own.f0 != nullptr ? &unit.schlick : nullptr,
                  own.passes},
                 parts.intensity[p], direct);
    }
}

void Gatherer::gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
                      GatheredLight& out) {
    clear_counts(out);
    CutSums sums(lanes);
    std::fill(std::begin(luminance_), std::end(luminance_), 0.0f);
    if (limits.exact) gather_exact(lanes, sums, out);
    std::copy(std::begin(luminance_), std::end(luminance_), std::begin(exact_luminance_));
    shields_.choose(lanes, tracer_.shields());
    rule_.start(limits.stop, limits.caution, tolerance.absolute, tolerance.relative, tolerance.base);
    start_cut(lanes, out);
    limits.stop == Stop::classic ? refine_classic(lanes, limits, out) : refine_honest(lanes, limits, out);

    sum_slots(lanes, limits.stop == Stop::honest, sums, out);
    sums.store(out);
}

void Gatherer::sum_slots(const GatherLanes& lanes, bool finely, CutSums& sums, GatheredLight& out) {
    const auto count = static_cast<std::uint32_t>(slots_.size());
    // Look ahead, so that memory is there when it is wanted.
    Parts next;
    if (finely && count > 0) next = parts_of(lanes, slots_[0]);
    for (std::uint32_t s = 0; s < count; ++s) {
        const Parts parts = next;
        if (finely && s + 1 < count) next = parts_of(lanes, slots_[s + 1]);
        if (finely && s + 2 < count) fetch(forest_.trees[slots_[s + 2].tree], slots_[s + 2].ref);
        const Slot& slot = slots_[s];
        const LightTree& tree = forest_.trees[slot.tree];
        const bool direct = LightForest::is_direct(slot.tree);
        if (slot.ref.is_leaf() || !finely)
            sums.add(unit_of(s), slot.intensity, direct);
        else if (slot.lit != 0)
            sum_finely(lanes, s, parts, sums);
        if (slot.any_clamped)
            sums.add_clamped(tree.family, tree.lights[slot.representative], unit_of(s), slot.intensity);
        ++(direct ? out.direct_clusters : out.indirect_clusters);
    }
}

void Gatherer::gather_exact(const GatherLanes& lanes, GatheredLight& out) {
    clear_counts(out);
    CutSums sums(lanes);
    std::fill(std::begin(luminance_), std::end(luminance_), 0.0f);
    gather_exact(lanes, sums, out);
    sums.store(out);
}

void Gatherer::gather_all(const GatherLanes& lanes, GatheredLight& out) {
    clear_counts(out);
    CutSums sums(lanes);
    gather_exact(lanes, sums, out);
    Arrival arrival;
    // Lanes that no ray of a packet is traced for keep what they had.
    std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest_.trees[t];
        for (const TreeLight& light : tree.lights) {
            if (!(core::luminance(light.intensity) > 0.0f)) continue;
            trace(lanes, tree.family, light, forest_.clamp(t), arrival, out);
            const UnitLight unit = unit_of(lanes, arrival);
            sums.add(unit, light.intensity, LightForest::is_direct(t));
            if (arrival.unit.any_clamped) sums.add_clamped(tree.family, light, unit, light.intensity);
        }
        (LightForest::is_direct(t) ? out.direct_clusters : out.indirect_clusters) +=
            static_cast<int>(tree.lights.size());
    }
    sums.store(out);
}

}  // namespace render2mpeg::renderer
