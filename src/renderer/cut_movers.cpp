// Clusters that something moves before: a cluster whose representative is all that says whether it is seen comes and
// goes whole as a mover passes, and what a picture shows about the mover flickers (docs/decisions/0017). Where a mover
// hides some lights of a cluster and others not, a finished cut has the cluster's parts instead.
#include <algorithm>
#include <limits>

#include "renderer/cut.h"
#include "renderer/isa_clones.h"
#include "renderer/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// How far below a cluster its parts may lie. chosen: 2 of 1, 2, 4 and 20 (docs/decisions/0017).
constexpr int most_levels = 2;

/// What less urgent clusters send, bounds of some 2 % of what a point tolerates, is not looked at. chosen: 0.01 of 1e-4
/// (the same changes from frame to frame, 1.004 times the rays) to 0.1 (nothing is left of the gain at 2 %).
constexpr float least_looked_at = 0.01f;

/// Rays that are traced, against instances alone (all that moves, and what is placed many times), to learn whether a cluster is hidden in part: as many as a packet
/// has. What so many do not tell stays as it is: mostly it is hidden altogether. chosen: 16 of 4, 8 and 16.
constexpr int most_looks = 16;

/// The rays of a packet that leave their surface and meet the front of the light.
RENDER2MPEG_CLONES
std::uint32_t facing(const GatherLanes& lanes, LightFamily family, const glm::vec3& normal,
                     const ShadowPacket& packet) {
    std::uint32_t rays = 0;
    const float least = family == LightFamily::oriented ? 0.0f : -std::numeric_limits<float>::infinity();
    for (int i = 0; i < lane_count; ++i) {
        const float x = packet.direction_x[i], y = packet.direction_y[i], z = packet.direction_z[i];
        const float off = x * lanes.geometric.x[i] + y * lanes.geometric.y[i] + z * lanes.geometric.z[i];
        const float from = -(x * normal.x + y * normal.y + z * normal.z);
        rays |= off > 0.0f && from > least ? 1u << i : 0u;
    }
    return rays;
}

}  // namespace

/// Whether for some lane what moves hides one of a cluster's lights and another not. Lanes do not count for which
/// something still hides its representative.
bool Gatherer::is_half_hidden(const GatherLanes& lanes, std::uint32_t index, GatheredLight& out) {
    const Slot& slot = slots_[index];
    const LightTree& tree = forest_.trees[slot.tree];
    const Parts parts = parts_of(lanes, slot);
    ShadowPacket packets[4];
    std::uint32_t passed[4], any = 0;
    for (int p = 0; p < parts.count; ++p) {
        const TreeLight& light = tree.lights[parts.light[p]];
        aim(lanes, tree.family, light, packets[p]);
        passed[p] = movers_.passed(packets[p]);
        any |= passed[p];
    }
    for (int p = 0; p < parts.count && any != 0; ++p)
        packets[p].active = facing(lanes, tree.family, tree.lights[parts.light[p]].normal(), packets[p]);
    int looks = 0;
    for (int n = 0; n < lane_count && any != 0; ++n) {
        // Lanes in a row lie side by side: take every fifth.
        const int lane = n * 5 % lane_count;
        if ((any >> lane & 1u) == 0) continue;
        const bool lit = ((slot.lit | slot.unknown) >> lane & 1) != 0;
        bool free = false, hidden = false, walled = false;
        for (int p = 0; p < parts.count && !walled && !(free && hidden); ++p) {
            if ((packets[p].active >> lane & 1u) == 0) continue;
            bool met = false;
            if ((passed[p] >> lane & 1u) != 0) {
                if (looks++ == most_looks) return false;
                ++out.shadow_rays;
                const ShadowPacket& rays = packets[p];
                met = tracer_.meets_instances({rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]},
                                              {rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]},
                                              rays.far[lane]);
            }
            walled = !met && !lit && parts.light[p] == slot.representative;
            (met ? hidden : free) = true;
        }
        if (!walled && free && hidden) return true;
    }
    return false;
}

void Gatherer::divide_behind_movers(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out) {
    movers_.choose(lanes, tracer_.movers());
    if (movers_.empty()) return;
    behind_.clear();
    for (auto i = static_cast<std::uint32_t>(slots_.size()); i-- > 0;) behind_.push_back({i, most_levels});
    while (!behind_.empty() && slots_.size() < static_cast<std::size_t>(limits.most)) {
        const Behind next = behind_.back();
        behind_.pop_back();
        const Slot& slot = slots_[next.slot];
        if (slot.ref.is_leaf() || slot.is_hidden || !(rule_.urgency(slot.bound) > least_looked_at)) continue;
        const LightTree& tree = forest_.trees[slot.tree];
        const MiddleBox box = tree.box(slot.ref.index());
        if (!movers_.may_hide(tree.family, box.middle, box.half) || !is_half_hidden(lanes, next.slot, out)) continue;
        const Divided parts = divide(lanes, next.slot, out);
        // No part's bound is larger than the whole's.
        std::copy(std::begin(slots_[next.slot].bound), std::end(slots_[next.slot].bound),
                  std::begin(slots_[parts.added].bound));
        if (next.levels == 1) continue;
        behind_.push_back({parts.added, next.levels - 1});
        behind_.push_back({next.slot, next.levels - 1});
    }
}

}  // namespace render2mpeg::renderer
