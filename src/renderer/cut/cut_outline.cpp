// Cuts that begin with what the cut of a neighbouring group could not do without (docs/decisions/0021).
#include "renderer/cut/cut_outline.h"

#include <algorithm>
#include <limits>

#include "core/numeric.h"
#include "renderer/cut/cut.h"

namespace render2mpeg::renderer {
namespace {

/// By how much, in bounds, a neighbour's split must have been more urgent than what its cut accepted. chosen: of 1.05
/// to 1.6 and of 1.2 to 3 (docs/fits/lightcut.md).
constexpr float classic_margin = 1.5f, honest_margin = 2.0f;

/// Of who reflects light and tolerates nothing: far above all others, but with a quotient.
constexpr float strictest_of_all = 1e18f;

/// Of how much of the most that a cut may have a neighbour's splits may take: the rest is for its own. chosen: 3/4, not
/// tuned; cuts that end at the most are rare.
constexpr std::size_t replayed_of(std::size_t most) {
    return most - most / 4;
}

/// What a lane reflects: what makes luminance of irradiance, about.
float reflected(const GatherLanes& lanes, int i) {
    const auto sum = [i](const Vec3Lanes& v) { return v.x[i] + v.y[i] + v.z[i]; };
    return sum(lanes.diffuse_weight) + (lanes.glossy ? sum(lanes.f0_weight) : 0.0f);
}

}  // namespace

float Gatherer::in_bounds(float priority, float factor) const {
    return priority * (rule_.stop() == Stop::classic ? factor : factor * factor);
}

float Gatherer::strictness(const GatherLanes& lanes, const Lanes& luminance) const {
    float strictest = 0.0f;
    for (int i = 0; i < lanes.count; ++i)
        strictest = std::max(strictest, core::divide_or(reflected(lanes, i), rule_.tolerance(i, luminance[i]),
                                                        reflected(lanes, i) > 0.0f ? strictest_of_all : 0.0f));
    return strictest;
}

void Gatherer::outline(const GatherLanes& lanes, CutOutline& out) const {
    out.splits = history_;
    // What was urgent because little light was known yet may not have been so in the end.
    const float tolerance = rule_.tolerance(0, luminance_[0]);
    for (CutOutline::Split& split : out.splits)
        split.priority = in_bounds(split.priority, core::divide_or(split.tolerance, tolerance, 1.0f));
    // Nothing is less urgent than its parts; what was split where nothing was tolerated had no measure of its own.
    for (std::size_t n = out.splits.size(); n-- > 0;) {
        const CutOutline::Split& split = out.splits[n];
        if ((split.part & CutOutline::of_root) != 0) continue;
        float& of_whole = out.splits[split.part / 2].priority;
        of_whole = std::max(of_whole, split.priority);
    }
    // What is left in the queue was accepted, or the cut had no room for it. Where nothing is left all that was split
    // had to be.
    if (!queue_.empty())
        out.enough = queue_.priority();
    else
        for (out.enough = std::numeric_limits<float>::max(); const CutOutline::Split& split : out.splits)
            out.enough = std::min(out.enough, split.priority);
    if (rule_.stop() == Stop::classic) out.enough = queue_.empty() ? 1.0f : std::max(1.0f, out.enough);
    out.strictness = strictness(lanes, luminance_);
    float light = 0.0f, reflects = 0.0f;
    for (int i = 0; i < lanes.count; ++i) {
        light += luminance_[i];
        reflects += reflected(lanes, i);
    }
    out.irradiance = core::divide_or(light, reflects, 0.0f);
}

float Gatherer::least_priority(const GatherLanes& lanes, const CutOutline& outline) const {
    Lanes expected;
    for (int i = 0; i < lane_count; ++i) expected[i] = outline.irradiance * reflected(lanes, i);
    // Where this group's tolerances are looser, what was urgent there is less so here.
    const float strict = strictness(lanes, expected);
    if (!(strict > 0.0f)) return std::numeric_limits<float>::max();
    const float looser = std::max(core::divide_or(outline.strictness, strict, 1.0f), 1.0f);
    if (rule_.stop() == Stop::classic) return outline.enough * looser * classic_margin;
    // Where errors may be larger there are fewer clusters to share them, about in proportion.
    return outline.enough * honest_margin * honest_margin * looser * looser * looser;
}

void Gatherer::replay(const GatherLanes& lanes, const CutOutline& outline, const CutLimits& limits,
                      GatheredLight& out) {
    const float least = least_priority(lanes, outline);
    const std::size_t most = replayed_of(static_cast<std::size_t>(std::max(limits.most, 1)));
    slot_of_.assign(2 * outline.splits.size(), no_slot);
    // What a later split will be of, as far as is known now.
    const auto slot_ahead = [&](std::size_t n) {
        if (n >= outline.splits.size() || !(outline.splits[n].priority >= least)) return no_slot;
        const std::uint32_t part = outline.splits[n].part;
        return (part & CutOutline::of_root) != 0 ? root_slot_[part & ~CutOutline::of_root] : slot_of_[part];
    };
    for (std::uint32_t n = 0; n < outline.splits.size() && slots_.size() < most; ++n) {
        const std::uint32_t slot = slot_ahead(n);
        // What is hidden from these points needs no parts.
        if (slot == no_slot || (slots_[slot].is_dark && hide(lanes, slot))) continue;
        const std::uint32_t next = slot_ahead(n + 1), after = slot_ahead(n + 2);
        if (after != no_slot && after != slot) fetch_split(after);
        if (next != no_slot && next != slot) fetch_light(lanes, next);
        const Divided parts = divide(lanes, slot, out);
        slot_of_[2 * n + (parts.first_keeps ? 0 : 1)] = slot;
        slot_of_[2 * n + (parts.first_keeps ? 1 : 0)] = parts.added;
    }
}

}  // namespace render2mpeg::renderer
