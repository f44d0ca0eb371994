// Clusters that something moves before: a cluster whose representative is all that says whether it is seen comes and
// goes whole as a dynamic object passes, and what a picture shows about the dynamic object flickers
// (docs/decisions/0017). Where a dynamic object comes before some of a cluster's four parts, each of them has a
// visibility of its own: that of the representative past what is still, times its own past what moves.
#include <algorithm>
#include <limits>

#include "renderer/base/isa_clones.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// What is less urgent than so much of the mean of a cut's clusters is not looked at. chosen: 0.5 of 0.2 to 2: up to it
/// changes from frame to frame are the same, at 1 a fourth of the gain at 2 % is lost (docs/decisions/0017).
constexpr float least_looked_at = 0.5f;

/// The rays of a packet that leave their surface and meet the front of the light.
RENDER2MPEG_CLONES
std::uint32_t facing(const GatherLanes& lanes, LightType type, const glm::vec3& normal, const ShadowPacket& packet) {
    std::uint32_t rays = 0;
    const float least = type == LightType::oriented ? 0.0f : -std::numeric_limits<float>::infinity();
    for (int i = 0; i < lane_count; ++i) {
        const float x = packet.direction_x[i], y = packet.direction_y[i], z = packet.direction_z[i];
        const float off = x * lanes.geometric.x[i] + y * lanes.geometric.y[i] + z * lanes.geometric.z[i];
        const float from = -(x * normal.x + y * normal.y + z * normal.z);
        rays |= off > 0.0f && from > least ? 1u << i : 0u;
    }
    return rays;
}

}  // namespace

/// Finds what dynamic objects leave of a cluster's parts in each lane, if a way to one of them leads through a dynamic
/// object's box.
void Gatherer::veil(const GatherLanes& lanes, std::uint32_t index, GatheredLight& out) {
    Slot& slot = slots_[index];
    const LightTree& tree = light_trees_.trees[slot.tree];
    const Parts parts = parts_of(lanes, slot);
    ShadowPacket packets[4];
    std::uint32_t passed[4], any = 0;
    int own = 0;
    for (int p = 0; p < parts.count; ++p) {
        if (parts.light[p] == slot.representative) own = p;
        aim(lanes, tree.type, tree.lights[parts.light[p]], packets[p]);
        passed[p] = dynamic_objects_.passed(packets[p]);
        any |= passed[p];
    }
    if (any == 0) return;
    std::uint32_t others = 0;
    for (int p = 0; p < parts.count; ++p) {
        passed[p] &= facing(lanes, tree.type, tree.lights[parts.light[p]].normal(), packets[p]);
        if (p != own) others |= passed[p];
    }
    const auto trace = [&](ShadowPacket& packet, std::uint32_t rays) -> std::uint32_t {
        if (rays == 0) return 0;
        packet.active = rays;
        out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(rays));
        return tracer_.occluded_by_dynamic(packet);
    };

    // Where the representative is lit, nothing moves before it. Where it is not, that may be for what moves alone.
    const std::uint32_t lit = slot.lit;
    const std::uint32_t before_own = trace(packets[own], passed[own] & ~lit);
    std::uint32_t freed = before_own;
    if (before_own != 0) {
        packets[own].active = before_own;
        out.shadow_rays += static_cast<std::uint64_t>(__builtin_popcount(before_own));
        glm::vec3 passes[lane_count];
        std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
        freed &= ~tracer_.occluded_by_static(packets[own], light_trees_.translucent ? passes : nullptr);
        for (int i = 0; i < lane_count && light_trees_.translucent; ++i)
            for (int k = 0; k < 3 && (freed >> i & 1u) != 0; ++k) tints_[index].passes[i][k] = passes[i][k];
    }
    if (freed == 0 && (others & lit) == 0) return;
    Veil found;
    for (int p = 0; p < parts.count; ++p) {
        const std::uint32_t met = p == own ? before_own : trace(packets[p], passed[p] & (lit | freed));
        found.lit[p] = static_cast<std::uint16_t>((lit | freed) & ~met);
    }
    slot.veil = static_cast<std::uint32_t>(veils_.size());
    veils_.push_back(found);
}

void Gatherer::look_behind_movers(const GatherLanes& lanes, GatheredLight& out) {
    veils_.clear();
    dynamic_objects_.choose(lanes, tracer_.dynamic_objects());
    if (dynamic_objects_.empty() || slots_.empty()) return;
    float all = 0;
    for (const Slot& slot : slots_) all += slot.is_hidden ? 0.0f : rule_.priority(slot.bound);
    const float least = least_looked_at * all / static_cast<float>(slots_.size());
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        const Slot& slot = slots_[i];
        if (slot.ref.is_leaf() || slot.is_hidden || !(rule_.priority(slot.bound) > least)) continue;
        const LightTree& tree = light_trees_.trees[slot.tree];
        const MiddleBox box = tree.box(slot.ref.index());
        if (dynamic_objects_.may_hide(tree.type, box.middle, box.half)) veil(lanes, i, out);
    }
}

}  // namespace render2mpeg::renderer
