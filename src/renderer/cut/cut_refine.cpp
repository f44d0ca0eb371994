// How a cut grows: the order of refinement, and when each of the stopping rules has enough (cut_rule.h).
#include <algorithm>
#include <limits>

#include "renderer/base/isa_clones.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/cut_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Squares of what is larger than this (in units of what a point tolerates) leave no digits of the others in a running
/// sum. chosen: 1e8, which leaves half of a double's; clusters that hold the point itself reach 1e30.
constexpr float drowning_priority = 1e8f;

/// A luminance that was once this many times what it is now has lost digits in a running sum. chosen: 64, which leaves
/// errors of about 1e-4 after a thousand clusters, a hundredth of any tolerance in use.
constexpr float drowning_peak = 64.0f;

RENDER2MPEG_ALWAYS_INLINED float finite(float bound) {
    return bound < std::numeric_limits<float>::max() ? bound : std::numeric_limits<float>::max();
}

}  // namespace

RENDER2MPEG_CLONES
void Gatherer::push(const GatherLanes& lanes, std::uint32_t index) {
    Slot& slot = slots_[index];
    slot.is_open = false;
    if (slot.ref.is_leaf() || slot.is_hidden) {
        std::fill(std::begin(slot.bound), std::end(slot.bound), 0.0f);
        return;
    }
    const LightTree& tree = light_trees_.trees[slot.tree];
    if (light_trees_.shadows == Shadows::hidden_by_dynamic) {
        const MiddleBox box = tree.box(slot.ref.index());
        if (!dynamic_objects_.can_hide(tree.type, box.middle, box.half)) {
            std::fill(std::begin(slot.bound), std::end(slot.bound), 0.0f);
            slot.lit = slot.unknown = 0;
            return;
        }
    }
    bound_node(lanes, tree, slot.ref.index(), light_trees_.clamp(slot.tree), slot.bound);
    const float priority = rule_.priority(slot.bound);
    if (!(priority > 0.0f)) return;
    // Ask shields about what is dark and would be refined.
    if (slot.is_dark && rule_.matters(priority) && hide(lanes, index)) {
        std::fill(std::begin(slot.bound), std::end(slot.bound), 0.0f);
        return;
    }
    slot.is_open = true;
    // Classic: what is fine enough waits until all light is known.
    if (rule_.stop() == Stop::classic && CutRule::accepts(priority) && slots_.size() >= least_)
        settled_.push_back({priority, index});
    else
        queue_.push(priority, index);
}

RENDER2MPEG_CLONES
void Gatherer::sum_luminance(const GatherLanes& lanes) {
    alignas(64) Lanes sum;
    for (int i = 0; i < lane_count; ++i) sum[i] = exact_luminance_[i];
    const auto count = static_cast<std::uint32_t>(slots_.size());
    for (std::uint32_t s = 0; s < count; ++s) add_luminance(lanes, unit_of(s), slots_.data()[s].intensity, sum);
    for (int i = 0; i < lane_count; ++i) luminance_[i] = peak_[i] = sum[i];
    rule_.observe(luminance_);
}

bool Gatherer::reopen(const GatherLanes& lanes) {
    // Sum the luminance afresh where running differences have lost digits.
    for (int i = 0; i < lane_count; ++i) {
        if (!(peak_[i] > drowning_peak * luminance_[i])) continue;
        sum_luminance(lanes);
        break;
    }
    // Hold every cluster against it that may have become too coarse.
    const float risen = rule_.risen();
    std::size_t still = 0;
    for (Settled s : settled_) {
        if (s.priority * risen > 1.0f) s.priority = rule_.priority(slots_[s.slot].bound);
        if (CutRule::accepts(s.priority))
            settled_[still++] = s;
        else
            queue_.push(s.priority, s.slot);
    }
    settled_.resize(still);
    return !queue_.empty();
}

void Gatherer::refine_classic(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out) {
    const auto most = static_cast<std::size_t>(std::max(limits.most, 1));
    while (!queue_.empty() || reopen(lanes)) {
        // The tolerance has moved since the entry was made.
        const std::uint32_t index = queue_.pop();
        const float priority = rule_.priority(slots_[index].bound);
        if (CutRule::accepts(priority) && slots_.size() >= least_) {
            settled_.push_back({priority, index});
            continue;
        }
        if (slots_.size() >= most) {
            for (const Slot& slot : slots_)
                if (slot.is_open) out.capped |= rule_.broken(slot.bound);
            break;
        }
        split(lanes, index, priority, out);
    }
    for (const Slot& slot : slots_)
        for (int i = 0; i < lane_count; ++i) out.error[i] = std::max(out.error[i], slot.bound[i]);
}

RENDER2MPEG_CLONES
void Gatherer::add_square(std::uint32_t index, double sign) {
    const Slot& slot = slots_[index];
    for (int i = 0; i < lane_count; ++i) {
        const double bound = finite(slot.bound[i]);
        squares_[i] += sign * (bound * bound);
    }
}

RENDER2MPEG_CLONES
void Gatherer::sum_afresh(const GatherLanes& lanes) {
    sum_luminance(lanes);
    alignas(64) double squares[lane_count] = {};
    alignas(64) Lanes largest = {};
    const Slot* const slots = slots_.data();
    const std::size_t count = slots_.size();
    for (std::size_t s = 0; s < count; ++s) {
        for (int i = 0; i < lane_count; ++i) {
            const double bound = finite(slots[s].bound[i]);
            squares[i] += bound * bound;
        }
        for (int i = 0; i < lane_count; ++i) largest[i] = inlined::max(largest[i], finite(slots[s].bound[i]));
    }
    for (int i = 0; i < lane_count; ++i) squares_[i] = squares[i];
    for (int i = 0; i < lane_count; ++i) largest_[i] = largest[i];
}

bool Gatherer::is_safe(const GatherLanes& lanes) {
    sum_afresh(lanes);
    if (rule_.broken(squares_, largest_) == 0) return true;
    // Tolerances have moved since the clusters were ranked. Of those in the way note the one that would come last.
    queue_.clear();
    witness_ = no_slot;
    float last = std::numeric_limits<float>::max();
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        if (!slots_[i].is_open) continue;
        const float priority = rule_.priority(slots_[i].bound);
        queue_.push(priority, i);
        if (priority >= last || !rule_.is_in_the_way(slots_[i].bound, squares_)) continue;
        witness_ = i;
        last = priority;
    }
    return false;
}

/// Whether it is worth a look at all clusters, which takes as long as some splits.
bool Gatherer::seems_safe(float safe_priority) {
    if (rule_.satisfied(squares_)) return true;
    const auto clear = [this](std::uint32_t slot) { return !rule_.is_in_the_way(slots_[slot].bound, squares_); };
    return queue_.priority() <= safe_priority && clear(queue_.front()) && (witness_ == no_slot || clear(witness_));
}

void Gatherer::refine_honest(const GatherLanes& lanes, const CutLimits& limits, GatheredLight& out) {
    const auto most = static_cast<std::size_t>(std::max(limits.most, 1));
    const float safe_priority = CutRule::safe_priority(lanes.count);
    bool summed = false, accepted = false;
    std::size_t next_look = least_;
    witness_ = no_slot;
    while (!queue_.empty() && slots_.size() < most) {
        // Keep a running sum once its largest parts are gone; what it says is checked against a fresh one.
        if (!summed && queue_.priority() < drowning_priority) {
            sum_afresh(lanes);
            summed = true;
        }
        if (summed && slots_.size() >= next_look && seems_safe(safe_priority)) {
            accepted = is_safe(lanes);
            if (accepted) break;
            next_look = slots_.size() + 1 + slots_.size() / 32;
        }
        const float priority = queue_.priority();
        const std::uint32_t index = queue_.pop();
        const auto added = static_cast<std::uint32_t>(slots_.size());
        if (summed) add_square(index, -1.0);
        split(lanes, index, priority, out);
        if (!summed) continue;
        add_square(index, 1.0);
        add_square(added, 1.0);
    }
    if (!accepted) {
        sum_afresh(lanes);
        out.capped |= rule_.broken(squares_, largest_);
    }
    for (int i = 0; i < lane_count; ++i) out.error[i] = rule_.error(i, squares_[i], largest_[i]);
}

}  // namespace render2mpeg::renderer
