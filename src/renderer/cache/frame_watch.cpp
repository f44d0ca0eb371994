// Points that records served, gathered all the same: how far records are to be trusted.
#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/cache/frame_lighting.h"

namespace render2mpeg::renderer {
namespace {

/// Of the points that records serve in a frame. chosen: 1 %, but as many as to tell something, and no more than settle
/// strictness within some frames, nor, once that has happened, than hold it; not tuned.
constexpr double watched_share = 0.01, least_watched = 64, most_watched = 256, most_watched_later = 96;

/// Of few that records serve, not so many that serving were in vain.
constexpr double largest_share = 0.25;

/// They are gathered so much finer than their tolerance, else a cut's own errors would count as the records'. chosen:
/// 3, at which errors of 0.4 tolerances, root of the mean square, seem 0.42.
constexpr float finer = 3.0f;

constexpr std::uint64_t dice = 0x7a1c;  ///< seed of core::uniform

}  // namespace

/// Those that the dice choose, by tiles; and how many of the points that have asked so far records serve.
std::vector<std::vector<PointRef>> FrameLighting::watched(Watch when, const RecordWatch& known,
                                                          float& served_share) const {
    double served = 0, asked = 0;
    for (std::size_t t = 0; t < state_.size(); ++t) {
        for (std::size_t i = 0; i < state_[t].size(); ++i) {
            asked += state_[t][i] != PointState::open ? 1 : 0;
            served += is_served(t, i) ? 1 : 0;
        }
    }
    served_share = static_cast<float>(core::divide_or(served, asked, 0.0));
    const double most = known.is_full() ? most_watched_later : most_watched;
    const double wanted = when == Watch::early ? most : std::clamp(watched_share * served, least_watched, most);
    const auto share = static_cast<float>(std::min(core::divide_or(wanted, served, 0.0), largest_share));
    std::vector<std::vector<PointRef>> chosen(state_.size());
    for (std::uint32_t t = 0; t < state_.size(); ++t) {
        const auto stream = static_cast<std::uint64_t>(snapshot_.frame) * state_.size() + t;
        for (std::uint32_t i = 0; i < state_[t].size(); ++i)
            if (is_served(t, i) && core::uniform(dice, stream, i, when == Watch::early ? 1 : 0) < share)
                chosen[t].push_back({t, i});
    }
    return chosen;
}

/// Points that records served, in this frame or in the last, and would not serve by what is known now ask again.
void FrameLighting::doubt_served() {
    for (std::size_t t = 0; t < state_.size(); ++t) {
        for (std::size_t i = 0; i < state_[t].size(); ++i) {
            if (!is_served(t, i) && state_[t][i] != PointState::recalled) continue;
            if (!(light_[t][i].doubt * trust_.strictness > 1.0f)) continue;
            state_[t][i] = PointState::open;
            light_[t][i] = {};
            --served_[t];
        }
    }
}

void FrameLighting::watch(Watch when, RecordWatch& known, ShadeCounts& counts, RecordCounts& record_counts) {
    std::vector<WatchedPoint> points;
    const float usual = limits_.error_scale;
    float share = 0;
    limits_.error_scale *= finer;
    for (const GatheredRequests& g : gather(watched(when, known, share), 0, counts)) {
        for (std::size_t k = 0; k < g.points.size(); ++k) {
            const PointRef& ref = g.points[k];
            const GatherPoint& p = point(ref);
            const glm::vec3 found = g.light[k].scattered(p), told = light_[ref.tile][ref.index].scattered(p);
            const float allowed = tolerances_[ref.tile][ref.index].allows(core::luminance(found));
            const float miss = core::divide_or(core::noticed(found - told), allowed, 0.0f);
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
    limits_.error_scale = usual;
    known.learn(points);
    trust_.strictness = known.strictness();
}

}  // namespace render2mpeg::renderer
