// What a finished cut sends: each cluster's light, its geometry summed over four lights of it where the stopping rule
// is honest (docs/model/lightcut.md).
#include "renderer/base/isa_clones.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/cut_sums.h"

namespace render2mpeg::renderer {
namespace {

void fetch_grandchildren(const LightTree& tree, LightRef ref) {
    if (ref.is_leaf()) return;
    for (const int side : {0, 1}) {
        const LightRef child = tree.child(ref.index(), side);
        if (child.is_leaf()) continue;
        for (const int of_child : {0, 1}) fetch(tree, tree.child(child.index(), of_child));
    }
}

}  // namespace

Gatherer::Parts Gatherer::parts_of(const GatherLanes& lanes, const Slot& slot) const {
    Parts parts;
    if (slot.ref.is_leaf()) return parts;
    const LightTree& tree = light_trees_.trees[slot.tree];
    const auto take = [&](LightRef part, std::uint32_t light) {
        parts.light[parts.count] = light;
        parts.intensity[parts.count] = tree.intensity(part);
        fetch(tree, LightRef::leaf(light));
        ++parts.count;
    };
    // Calls `use` with both children of a node and their representatives.
    const auto both = [&](LightRef inner, std::uint32_t own, const auto& use) {
        const bool first = tree.first_represents(inner, lanes.set);
        const std::uint32_t other = tree.adopted_representative(inner, own, lanes.set);
        use(tree.child(inner.index(), 0), first ? own : other);
        use(tree.child(inner.index(), 1), first ? other : own);
    };
    // Of the children those that are lights stay as they are.
    both(slot.ref, slot.representative, [&](LightRef child, std::uint32_t light) {
        if (child.is_leaf())
            take(child, light);
        else
            both(child, light, take);
    });
    return parts;
}

RENDER2MPEG_CLONES
void Gatherer::sum_finely(const GatherLanes& lanes, std::uint32_t index, const Parts& parts, CutSums& sums) const {
    const Slot& slot = slots_[index];
    const LightTree& tree = light_trees_.trees[slot.tree];
    const bool direct = LightTrees::is_direct(slot.tree);
    const Veil* const veil = slot.veil == no_veil ? nullptr : &veils_[slot.veil];
    alignas(64) Lanes visible;
    const auto see = [&](std::uint16_t lanes_lit) {
        for (int i = 0; i < lane_count; ++i) {
            const float lit = (slot.unknown >> i & 1) != 0 ? 0.5f : 1.0f;
            visible[i] = (lanes_lit >> i & 1) != 0 ? lit : 0.0f;
        }
    };
    see(slot.lit);
    if (!lanes.glossy && !light_trees_.translucent) {
        // The representative's own light is what its rays let through of what it sends.
        Representative lights[4];
        for (int p = 0; p < parts.count; ++p)
            lights[p] = {&tree.lights[parts.light[p]], tree.spot(parts.light[p]), parts.intensity[p]};
        const int together = veil == nullptr ? parts.count : 1;
        for (int p = 0; p < parts.count; p += together) {
            if (veil != nullptr) see(veil->lit[p]);
            alignas(64) RgbLanes irradiance{};
            add_irradiance(lanes, tree.type, lights + p, together, light_trees_.clamp(slot.tree), irradiance);
            sums.add(irradiance, visible, direct);
        }
        return;
    }
    const UnitLight own = unit_of(index);
    for (int p = 0; p < parts.count; ++p) {
        if (parts.light[p] == slot.representative) {
            sums.add(own, parts.intensity[p], direct);
            continue;
        }
        if (veil != nullptr) see(veil->lit[p]);
        LightLanes unit;
        evaluate_light(lanes, tree.type, tree.lights[parts.light[p]], tree.spot(parts.light[p]),
                       light_trees_.clamp(slot.tree), unit);
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

void Gatherer::sum_slots(const GatherLanes& lanes, bool finely, CutSums& sums, GatheredLight& out) {
    const auto count = static_cast<std::uint32_t>(slots_.size());
    const auto is_seen = [](const Slot& slot) { return slot.lit != 0 || slot.veil != no_veil; };
    // Look ahead, so that memory is there when it is wanted: a node, its children, theirs, and who stands for these.
    const auto ahead = [&](std::uint32_t s) { return finely && s < count && is_seen(slots_[s]); };
    Parts next;
    if (ahead(0)) next = parts_of(lanes, slots_[0]);
    for (std::uint32_t s = 0; s < count; ++s) {
        const Parts parts = next;
        if (ahead(s + 4)) fetch(light_trees_.trees[slots_[s + 4].tree], slots_[s + 4].ref);
        if (ahead(s + 3) && !slots_[s + 3].ref.is_leaf()) fetch_split(s + 3);
        if (ahead(s + 2)) fetch_grandchildren(light_trees_.trees[slots_[s + 2].tree], slots_[s + 2].ref);
        if (ahead(s + 1)) next = parts_of(lanes, slots_[s + 1]);
        const Slot& slot = slots_[s];
        const LightTree& tree = light_trees_.trees[slot.tree];
        const bool direct = LightTrees::is_direct(slot.tree);
        if (slot.ref.is_leaf() || !finely)
            sums.add(unit_of(s), slot.intensity, direct);
        else if (is_seen(slot))
            sum_finely(lanes, s, parts, sums);
        if (slot.any_clamped) sums.add_clamped(tree.lights[slot.representative], unit_of(s), slot.intensity);
        ++(direct ? out.direct_clusters : out.indirect_clusters);
    }
}

}  // namespace render2mpeg::renderer
