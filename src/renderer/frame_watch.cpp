// Points that records served, gathered all the same: how far records are to be trusted.
#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/frame_lighting.h"

namespace render2mpeg::renderer {
namespace {

/// Of the points that records serve in a frame. chosen: 1 %, but as many as to tell something, and no more than settle
/// strictness within some frames; not tuned.
constexpr double watched_share = 0.01, least_watched = 64, most_watched = 256;

/// Of few that records serve, not so many that serving were in vain.
constexpr double largest_share = 0.25;

/// They are gathered so much finer than their tolerance, else a cut's own errors would count as the records'. chosen:
/// 3, at which errors of 0.4 tolerances, root of the mean square, seem 0.42.
constexpr float finer = 3.0f;

constexpr std::uint64_t dice = 0x7a1c;  ///< seed of core::uniform

/// What an eye notices of a difference, in luminance: chroma [BT709, 3.3] counts for half, as in the bounds.
float noticed(glm::vec3 off) {
    const float y = core::luminance(off);
    return std::max(std::abs(y), 0.5f * std::max(std::abs(off.x - y) / 1.5748f, std::abs(off.z - y) / 1.8556f));
}

}  // namespace

/// Those that the dice choose, by tiles; and how many of the points that have asked so far records serve.
std::vector<std::vector<PointRef>> FrameLighting::watched(bool first, float& served_share) const {
    double served = 0, asked = 0;
    for (std::size_t t = 0; t < state_.size(); ++t) {
        for (std::size_t i = 0; i < state_[t].size(); ++i) {
            asked += state_[t][i] != PointState::open ? 1 : 0;
            served += is_served(t, i) ? 1 : 0;
        }
    }
    served_share = static_cast<float>(core::divide_or(served, asked, 0.0));
    const double wanted = first ? most_watched : std::clamp(watched_share * served, least_watched, most_watched);
    const auto share = static_cast<float>(std::min(core::divide_or(wanted, served, 0.0), largest_share));
    std::vector<std::vector<PointRef>> chosen(state_.size());
    for (std::uint32_t t = 0; t < state_.size(); ++t) {
        const auto stream = static_cast<std::uint64_t>(snapshot_.frame) * state_.size() + t;
        for (std::uint32_t i = 0; i < state_[t].size(); ++i)
            if (is_served(t, i) && core::uniform(dice, stream, i, first ? 1 : 0) < share) chosen[t].push_back({t, i});
    }
    return chosen;
}

/// Points that records served and would not serve by what is known now ask again.
void FrameLighting::doubt_served() {
    for (std::size_t t = 0; t < state_.size(); ++t) {
        for (std::size_t i = 0; i < state_[t].size(); ++i) {
            if (!is_served(t, i) || !(light_[t][i].doubt * trust_.strictness > 1.0f)) continue;
            state_[t][i] = PointState::open;
            light_[t][i] = {};
            --served_[t];
        }
    }
}

void FrameLighting::watch(RecordWatch& watch, ShadeCounts& counts, RecordCounts& record_counts) {
    std::vector<WatchedPoint> points;
    const float usual = limits_.caution;
    float share = 0;
    limits_.caution *= finer;
    for (const GatheredRequests& g : gather(watched(!watch.knows(), share), 0, counts)) {
        for (std::size_t k = 0; k < g.points.size(); ++k) {
            const PointRef& ref = g.points[k];
            const GatherPoint& p = point(ref);
            const glm::vec3 found = g.light[k].scattered(p), told = light_[ref.tile][ref.index].scattered(p);
            const float allowed = tolerances_[ref.tile][ref.index].allows(core::luminance(found));
            const float miss = core::divide_or(noticed(found - told), allowed, 0.0f);
            if (!g.light[k].capped && std::isfinite(miss)) {
                points.push_back({light_[ref.tile][ref.index].doubt, miss, share});
                ++record_counts.watched;
                record_counts.missed += miss > 1.0f ? 1 : 0;
            }
            --served_[ref.tile];
            keep(g, k, record_counts);
            light_[ref.tile][ref.index].watched = true;
            state_[ref.tile][ref.index] = PointState::watched;
        }
    }
    limits_.caution = usual;
    watch.learn(points);
    trust_.strictness = watch.strictness();
}

}  // namespace render2mpeg::renderer
