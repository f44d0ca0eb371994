// Lightcuts [Walter2005, 4; Render2MPEG, algorithm 3] for groups of up to sixteen points. Changed: the points of a
// group share one cut, and with it one packet of shadow rays per refined cluster, but each keeps its own bounds,
// luminance and tolerance; the cut is refined until every point accepts every cluster. All trees share one heap, so
// that direct and indirect light are held against the pixel's total. A finished cut sums the geometry of each cluster
// over four lights of it, with the visibility of its one representative: geometry needs no rays.
#include "renderer/cut/cut.h"

#include <algorithm>

#include "core/color.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/isa_clones.h"
#include "renderer/cut/bias_compensation.h"
#include "renderer/cut/cut_sums.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

constexpr std::uint16_t all_lanes = 0xffff;

void clear_counts(GatheredLight& out) {
    out.direct_clusters = out.indirect_clusters = 0;
    out.capped = 0;
    out.shadow_rays = 0;
    std::fill(std::begin(out.error), std::end(out.error), 0.0f);
}

/// The lanes that the light could reach.
RENDER2MPEG_ALWAYS_INLINED std::uint32_t reached(const LightLanes& unit) {
    std::uint32_t lanes = 0;
    for (int i = 0; i < lane_count; ++i) lanes |= unit.diffuse[i] > 0.0f ? 1u << i : 0u;
    return lanes;
}

}  // namespace

RENDER2MPEG_CLONES
void Gatherer::trace(const GatherLanes& lanes, LightType type, const TreeLight& light, const Spot* spot,
                     GeometryClamp clamp, Arrival& arrival, GatheredLight& out) {
    evaluate_light(lanes, type, light, spot, clamp, arrival.unit);
    ShadowPacket packet;
    aim(lanes, type, light, packet);
    packet.active = reached(arrival.unit);
    arrival.is_blocked = false;
    if (packet.active == 0) return;
    std::uint32_t blocked = 0;
    if (light_trees_.translucent) {
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        blocked = tracer_.occluded(packet, passes);
        for (int i = 0; i < lane_count; ++i)
            for (int k = 0; k < 3 && (packet.active >> i & 1u) != 0; ++k) arrival.tint.passes[i][k] = passes[i][k];
        out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
    } else {
        blocked = withheld(packet, out);
    }
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

/// Bit i: ray i of the packet carries no light of the light trees'.
std::uint32_t Gatherer::withheld(const ShadowPacket& packet, GatheredLight& out) const {
    if (light_trees_.shadows != Shadows::hidden_by_dynamic) {
        out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
        return light_trees_.shadows == Shadows::of_everything ? tracer_.occluded(packet, nullptr)
                                                              : tracer_.occluded_by_static(packet, nullptr);
    }
    // What moves hides light that nothing still does.
    ShadowPacket rays = packet;
    rays.active &= dynamic_objects_.met(packet);
    if (rays.active == 0) return packet.active;
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(rays.active));
    rays.active &= tracer_.occluded_by_dynamic(rays);
    if (rays.active == 0) return packet.active;
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(rays.active));
    return packet.active & ~(rays.active & ~tracer_.occluded_by_static(rays, nullptr));
}

UnitLight Gatherer::unit_of(const GatherLanes& lanes, const Arrival& arrival) const {
    UnitLight unit = unit_light(lanes, arrival.unit);
    if (light_trees_.translucent) unit.passes = arrival.tint.passes;
    return unit;
}

void Gatherer::gather_exact(const GatherLanes& lanes, CutSums& sums, GatheredLight& out) {
    for (const ExactLight& exact : light_trees_.exact) {
        Arrival arrival;
        std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
        trace(lanes, exact.type, exact.light, &exact.spot, light_trees_.direct_clamp, arrival, out);
        const UnitLight unit = unit_of(lanes, arrival);
        add_luminance(lanes, unit, exact.light.intensity, luminance_);
        sums.add(unit, exact.light.intensity, true);
        ++out.direct_clusters;
    }
}

void Gatherer::trace_slot(const GatherLanes& lanes, std::uint32_t index, Arrival& arrival, GatheredLight& out) {
    Slot& slot = slots_[index];
    const LightTree& tree = light_trees_.trees[slot.tree];
    slot.intensity = tree.intensity(slot.ref);
    if (slot.is_dark && hide(lanes, index)) {
        std::fill(std::begin(slot.diffuse), std::end(slot.diffuse), 0.0f);
        if (lanes.glossy) {
            std::fill(std::begin(lobes_[index].f0), std::end(lobes_[index].f0), 0.0f);
            std::fill(std::begin(lobes_[index].schlick), std::end(lobes_[index].schlick), 0.0f);
        }
        if (light_trees_.translucent) tints_[index] = arrival.tint;
        slot.any_clamped = false;
        return;
    }
    trace(lanes, tree.type, tree.lights[slot.representative], tree.spot(slot.representative),
          light_trees_.clamp(slot.tree), arrival, out);
    std::copy(std::begin(arrival.unit.diffuse), std::end(arrival.unit.diffuse), std::begin(slot.diffuse));
    slot.lit = arrival.lit;
    slot.unknown = arrival.unknown;
    slot.any_clamped = arrival.unit.any_clamped;
    slot.is_dark = arrival.is_blocked;
    if (lanes.glossy) {
        std::copy(std::begin(arrival.unit.f0), std::end(arrival.unit.f0), std::begin(lobes_[index].f0));
        std::copy(std::begin(arrival.unit.schlick), std::end(arrival.unit.schlick), std::begin(lobes_[index].schlick));
    }
    if (light_trees_.translucent) tints_[index] = arrival.tint;
}

void Gatherer::start_cut(const GatherLanes& lanes, const CutLimits& limits, const CutOutline* begin_with,
                         GatheredLight& out) {
    slots_.clear();
    lobes_.clear();
    tints_.clear();
    queue_.clear();
    settled_.clear();
    history_.clear();
    for (int t = 0; t < LightTrees::tree_count; ++t) {
        const LightTree& tree = light_trees_.trees[t];
        if (tree.empty()) continue;
        const std::uint32_t index = add_slot(lanes, t, tree.root);
        slots_[index].part = CutOutline::of_root + static_cast<std::uint32_t>(t);
        slots_[index].representative = tree.representative(tree.root, lanes.set);
        root_slot_[t] = index;
        Arrival arrival;
        // Of light that dynamic objects would have to hide none counts before a ray says so.
        arrival.lit = arrival.unknown = light_trees_.shadows == Shadows::hidden_by_dynamic ? 0 : all_lanes;
        std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
        trace_slot(lanes, index, arrival, out);
    }
    if (begin_with != nullptr) replay(lanes, *begin_with, limits, out);
    sum_luminance(lanes);
    for (std::uint32_t i = 0; i < slots_.size(); ++i) push(lanes, i);
}

/// Whether nothing below a slot's node can be seen from any lane; then it counts as dark for all of them.
bool Gatherer::hide(const GatherLanes& lanes, std::uint32_t index) {
    Slot& slot = slots_[index];
    if (slot.is_tested || slot.shields == 0) return slot.is_hidden;
    slot.is_tested = true;
    const LightTree& tree = light_trees_.trees[slot.tree];
    const std::uint32_t index_in_tree = slot.ref.index();
    const MiddleBox box =
        slot.ref.is_leaf() ? MiddleBox{tree.lights[index_in_tree].position, glm::vec3(0)} : tree.box(index_in_tree);
    slot.is_hidden = shields_.hide(lanes, tree.type, box.middle, box.half, slot.shields);
    if (slot.is_hidden) slot.lit = slot.unknown = 0;
    return slot.is_hidden;
}

std::uint32_t Gatherer::add_slot(const GatherLanes& lanes, int tree, LightRef ref) {
    const auto index = static_cast<std::uint32_t>(slots_.size());
    Slot& slot = slots_.emplace_back();
    slot.tree = static_cast<std::uint8_t>(tree);
    slot.ref = ref;
    if (lanes.glossy) lobes_.emplace_back();
    if (light_trees_.translucent) tints_.emplace_back();
    return index;
}

/// Has on its way what splitting a slot asks for first: its node's children, and who stands for them.
void Gatherer::fetch_split(std::uint32_t index) const {
    const Slot& slot = slots_[index];
    const LightTree& tree = light_trees_.trees[slot.tree];
    for (const int side : {0, 1}) fetch(tree, tree.child(slot.ref.index(), side));
}

/// And the light, once that is known.
void Gatherer::fetch_light(const GatherLanes& lanes, std::uint32_t index) const {
    const Slot& slot = slots_[index];
    const LightTree& tree = light_trees_.trees[slot.tree];
    fetch(tree, LightRef::leaf(tree.adopted_representative(slot.ref, slot.representative, lanes.set)));
}

Gatherer::Divided Gatherer::divide(const GatherLanes& lanes, std::uint32_t index, GatheredLight& out) {
    const LightTree& tree = light_trees_.trees[slots_[index].tree];
    const LightRef parent = slots_[index].ref;
    // The child that holds the representative keeps its rays; only the other one, adopted, is traced.
    const bool first_keeps = tree.first_represents(parent, lanes.set);
    const LightRef kept = tree.child(parent.index(), first_keeps ? 0 : 1),
                   adopted = tree.child(parent.index(), first_keeps ? 1 : 0);
    const std::uint32_t added = add_slot(lanes, slots_[index].tree, adopted);
    Slot& old = slots_[index];
    slots_[added].representative = tree.adopted_representative(parent, old.representative, lanes.set);
    slots_[added].is_dark = old.is_dark;
    slots_[added].shields = old.shields;

    Arrival arrival;
    arrival.lit = old.lit;
    arrival.unknown = old.unknown;
    if (light_trees_.translucent) arrival.tint = tints_[index];
    trace_slot(lanes, added, arrival, out);

    old.ref = kept;
    old.is_tested = false;
    old.intensity = tree.intensity(kept);
    return {added, first_keeps};
}

RENDER2MPEG_CLONES
void Gatherer::split(const GatherLanes& lanes, std::uint32_t index, float priority, GatheredLight& out) {
    const glm::vec3 whole = slots_[index].intensity;
    // Fetch, while rays are traced, what the next split will most likely want.
    if (!queue_.empty()) fetch_split(queue_.front());
    const Divided parts = divide(lanes, index, out);
    if (!queue_.empty()) fetch_light(lanes, queue_.front());
    const auto n = static_cast<std::uint32_t>(history_.size());
    history_.push_back({slots_[index].part, priority, rule_.tolerance(0, luminance_[0])});
    slots_[index].part = 2 * n + (parts.first_keeps ? 0u : 1u);
    slots_[parts.added].part = 2 * n + (parts.first_keeps ? 1u : 0u);

    const glm::vec3& rest = slots_[index].intensity;
    const glm::vec3 change{rest.x - whole.x, rest.y - whole.y, rest.z - whole.z};
    add_luminance(lanes, unit_of(index), change, luminance_);
    add_luminance(lanes, unit_of(parts.added), slots_[parts.added].intensity, luminance_);
    for (int i = 0; i < lane_count; ++i) peak_[i] = inlined::max(peak_[i], luminance_[i]);
    rule_.observe(luminance_);
    push(lanes, index);
    push(lanes, parts.added);
}

void Gatherer::gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
                      GatheredLight& out, const CutOutline* begin_with) {
    const FlushDenormals flushed;
    clear_counts(out);
    CutSums sums(lanes);
    std::fill(std::begin(luminance_), std::end(luminance_), 0.0f);
    if (limits.exact) gather_exact(lanes, sums, out);
    std::copy(std::begin(luminance_), std::end(luminance_), std::begin(exact_luminance_));
    shields_.choose(lanes, tracer_.shields());
    if (light_trees_.shadows == Shadows::hidden_by_dynamic)
        dynamic_objects_.choose(lanes, tracer_.dynamic_objects(), 0.0f);
    rule_.start(limits.stop, limits.error_scale, tolerance);
    least_ = static_cast<std::size_t>(std::max(limits.least, 0));
    start_cut(lanes, limits, begin_with, out);
    limits.stop == Stop::classic ? refine_classic(lanes, limits, out) : refine_honest(lanes, limits, out);

    if (limits.stop == Stop::honest && light_trees_.shadows == Shadows::of_everything) look_behind_movers(lanes, out);
    sum_slots(lanes, limits.stop == Stop::honest, sums, out);
    sums.store(out);
    compensate_clamping_bias(light_trees_, tracer_, lanes, out);
}

void Gatherer::gather_exact(const GatherLanes& lanes, GatheredLight& out) {
    const FlushDenormals flushed;
    clear_counts(out);
    CutSums sums(lanes);
    std::fill(std::begin(luminance_), std::end(luminance_), 0.0f);
    gather_exact(lanes, sums, out);
    sums.store(out);
}

void Gatherer::gather_all(const GatherLanes& lanes, GatheredLight& out) {
    const FlushDenormals flushed;
    clear_counts(out);
    CutSums sums(lanes);
    gather_exact(lanes, sums, out);
    Arrival arrival;
    // Lanes that no ray of a packet is traced for keep what they had.
    std::fill(&arrival.tint.passes[0][0], &arrival.tint.passes[0][0] + lane_count * 3, 1.0f);
    for (int t = 0; t < LightTrees::tree_count; ++t) {
        const LightTree& tree = light_trees_.trees[t];
        for (std::uint32_t i = 0; i < tree.lights.size(); ++i) {
            const TreeLight& light = tree.lights[i];
            if (!(core::luminance(light.intensity) > 0.0f)) continue;
            trace(lanes, tree.type, light, tree.spot(i), light_trees_.clamp(t), arrival, out);
            const UnitLight unit = unit_of(lanes, arrival);
            sums.add(unit, light.intensity, LightTrees::is_direct(t));
            if (arrival.unit.any_clamped) sums.add_clamped(light, unit, light.intensity);
        }
        (LightTrees::is_direct(t) ? out.direct_clusters : out.indirect_clusters) +=
            static_cast<int>(tree.lights.size());
    }
    sums.store(out);
    compensate_clamping_bias(light_trees_, tracer_, lanes, out);
}

}  // namespace render2mpeg::renderer
