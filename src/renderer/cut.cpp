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
void Gatherer::trace(const GatherLanes& lanes, LightFamily family, const TreeLight& light, Slot& slot,
                     GatheredLight& out) {
    evaluate_light(lanes, family, light, forest_.clamp(slot.tree), slot.unit);
    ShadowPacket packet;
    aim(lanes, family, light, slot.unit, packet);
    std::uint32_t blocked = 0;
    if (forest_.translucent) {
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        if (packet.active != 0) blocked = tracer_.occluded(packet, passes);
        for (int i = 0; i < lane_count; ++i)
            for (int k = 0; k < 3 && (packet.active >> i & 1u) != 0; ++k) slot.passes[i][k] = passes[i][k];
    } else if (packet.active != 0) {
        blocked = tracer_.occluded(packet, nullptr);
    }
    out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(packet.active));
    std::uint32_t reached = 0;
    const std::uint32_t asked = packet.active;
    for (int i = 0; i < lane_count; ++i) {
        const float found = (blocked >> i & 1u) != 0 ? 0.0f : 1.0f;
        slot.visible[i] = (asked >> i & 1u) != 0 ? found : slot.visible[i];
        reached |= slot.visible[i] > 0.0f ? 1u : 0u;
    }
    slot.reaches_any = reached != 0;
    if (blocked == 0) return;
    for (int i = 0; i < lane_count; ++i) {
        const float visible = (blocked >> i & 1u) != 0 ? 0.0f : 1.0f;
        slot.unit.diffuse[i] *= visible;
        if (!lanes.glossy) continue;
        slot.unit.f0[i] *= visible;
        slot.unit.schlick[i] *= visible;
    }
}

void Gatherer::add_slot(const GatherLanes& lanes, const Slot& slot, glm::vec3 intensity, Lanes& luminance) const {
    if (!forest_.translucent) {
        add_luminance(lanes, slot.unit, intensity, luminance);
        return;
    }
    // Each lane sees the light in its own colour: once per channel, with what passes put into the unit values.
    for (int k = 0; k < 3; ++k) {
        LightLanes tinted;
        for (int i = 0; i < lane_count; ++i) {
            tinted.diffuse[i] = slot.unit.diffuse[i] * slot.passes[i][k];
            tinted.f0[i] = lanes.glossy ? slot.unit.f0[i] * slot.passes[i][k] : 0.0f;
            tinted.schlick[i] = lanes.glossy ? slot.unit.schlick[i] * slot.passes[i][k] : 0.0f;
        }
        glm::vec3 channel(0);
        channel[k] = intensity[k];
        add_luminance(lanes, tinted, channel, luminance);
    }
}

void Gatherer::gather_exact(const GatherLanes& lanes, CutSums& sums, GatheredLight& out) {
    for (const ExactLight& exact : forest_.exact) {
        Slot slot;
        std::fill(std::begin(slot.visible), std::end(slot.visible), 0.0f);
        std::fill(&slot.passes[0][0], &slot.passes[0][0] + lane_count * 3, 1.0f);
        trace(lanes, exact.family, exact.light, slot, out);
        add_slot(lanes, slot, exact.light.intensity, luminance_);
        sums.add(slot.unit, slot.passes, exact.light.intensity, true);
        ++out.direct_clusters;
    }
}

void Gatherer::start_cut(const GatherLanes& lanes, GatheredLight& out) {
    slots_.clear();
    heap_.clear();
    settled_.clear();
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest_.trees[t];
        if (tree.empty()) continue;
        Slot& slot = slots_.emplace_back();
        slot.tree = t;
        slot.ref = tree.root;
        slot.representative = tree.representative(tree.root, lanes.set);
        std::fill(std::begin(slot.visible), std::end(slot.visible), 0.5f);
        std::fill(&slot.passes[0][0], &slot.passes[0][0] + lane_count * 3, 1.0f);
        trace(lanes, tree.family, tree.lights[slot.representative], slot, out);
        add_slot(lanes, slot, tree.intensity(tree.root), luminance_);
    }
    rule_.observe(luminance_);
    for (std::uint32_t i = 0; i < slots_.size(); ++i) push(lanes, i);
}

RENDER2MPEG_CLONES
void Gatherer::split(const GatherLanes& lanes, std::uint32_t index, GatheredLight& out) {
    const LightTree& tree = forest_.trees[slots_[index].tree];
    const LightNode& node = tree.nodes[slots_[index].ref.index()];
    // The child that holds the representative keeps its rays; only the other one, adopted, is traced.
    const bool first_keeps = tree.first_represents(slots_[index].ref, lanes.set);
    const LightRef kept = node.child[first_keeps ? 0 : 1], adopted = node.child[first_keeps ? 1 : 0];
    Slot& old = slots_[index];
    old.ref = kept;
    add_slot(lanes, old, tree.intensity(kept) - node.intensity, luminance_);

    const auto added = static_cast<std::uint32_t>(slots_.size());
    Slot& slot = slots_.emplace_back();
    slot.tree = slots_[index].tree;
    slot.ref = adopted;
    slot.representative = tree.representative(adopted, lanes.set);
    std::copy(std::begin(slots_[index].visible), std::end(slots_[index].visible), std::begin(slot.visible));
    if (forest_.translucent)
        std::copy(&slots_[index].passes[0][0], &slots_[index].passes[0][0] + lane_count * 3, &slot.passes[0][0]);
    trace(lanes, tree.family, tree.lights[slot.representative], slot, out);
    add_slot(lanes, slot, tree.intensity(adopted), luminance_);
    rule_.observe(luminance_);
    push(lanes, index);
    push(lanes, added);
}

RENDER2MPEG_CLONES
void Gatherer::sum_finely(const GatherLanes& lanes, const Slot& slot, CutSums& sums) const {
    const LightTree& tree = forest_.trees[slot.tree];
    const bool direct = LightForest::is_direct(slot.tree);
    // The clusters two levels below: of the children those that are lights stay as they are.
    LightRef parts[4];
    int count = 0;
    for (const LightRef child : tree.nodes[slot.ref.index()].child) {
        if (child.is_leaf()) {
            parts[count++] = child;
            continue;
        }
        for (const LightRef part : tree.nodes[child.index()].child) parts[count++] = part;
    }
    for (int p = 0; p < count; ++p) {
        const std::uint32_t representative = tree.representative(parts[p], lanes.set);
        const glm::vec3 intensity = tree.intensity(parts[p]);
        if (representative == slot.representative) {
            sums.add(slot.unit, slot.passes, intensity, direct);
            continue;
        }
        LightLanes unit;
        evaluate_light(lanes, tree.family, tree.lights[representative], forest_.clamp(slot.tree), unit);
        for (int i = 0; i < lane_count; ++i) {
            unit.diffuse[i] *= slot.visible[i];
            if (!lanes.glossy) continue;
            unit.f0[i] *= slot.visible[i];
            unit.schlick[i] *= slot.visible[i];
        }
        sums.add(unit, slot.passes, intensity, direct);
    }
}

void Gatherer::gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
                      GatheredLight& out) {
    out.direct_clusters = out.indirect_clusters = 0;
    out.capped = 0;
    out.shadow_rays = 0;
    std::fill(std::begin(out.error), std::end(out.error), 0.0f);
    CutSums sums(lanes, forest_.translucent);
    std::fill(std::begin(luminance_), std::end(luminance_), 0.0f);
    gather_exact(lanes, sums, out);
    std::copy(std::begin(luminance_), std::end(luminance_), std::begin(exact_luminance_));
    rule_.start(limits.stop, limits.caution, tolerance.absolute, tolerance.relative, tolerance.base);
    start_cut(lanes, out);
    limits.stop == Stop::classic ? refine_classic(lanes, limits, out) : refine_honest(lanes, limits, out);

    for (const Slot& slot : slots_) {
        const LightTree& tree = forest_.trees[slot.tree];
        const bool direct = LightForest::is_direct(slot.tree);
        const glm::vec3 intensity = tree.intensity(slot.ref);
        if (slot.ref.is_leaf() || limits.stop == Stop::classic)
            sums.add(slot.unit, slot.passes, intensity, direct);
        else if (slot.reaches_any)
            sum_finely(lanes, slot, sums);
        if (slot.unit.any_clamped)
            sums.add_clamped(tree.family, tree.lights[slot.representative], slot.unit, intensity);
        ++(direct ? out.direct_clusters : out.indirect_clusters);
    }
    sums.store(out);
}

void Gatherer::gather_all(const GatherLanes& lanes, GatheredLight& out) {
    out.direct_clusters = out.indirect_clusters = 0;
    out.capped = 0;
    out.shadow_rays = 0;
    std::fill(std::begin(out.error), std::end(out.error), 0.0f);
    CutSums sums(lanes, forest_.translucent);
    gather_exact(lanes, sums, out);
    Slot slot;
    std::fill(std::begin(slot.visible), std::end(slot.visible), 0.0f);
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const LightTree& tree = forest_.trees[t];
        slot.tree = t;
        for (const TreeLight& light : tree.lights) {
            trace(lanes, tree.family, light, slot, out);
            sums.add(slot.unit, slot.passes, light.intensity, LightForest::is_direct(t));
            if (slot.unit.any_clamped) sums.add_clamped(tree.family, light, slot.unit, light.intensity);
        }
        (LightForest::is_direct(t) ? out.direct_clusters : out.indirect_clusters) +=
            static_cast<int>(tree.lights.size());
    }
    sums.store(out);
}

}  // namespace render2mpeg::renderer
