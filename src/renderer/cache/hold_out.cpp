#include "renderer/cache/hold_out.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/cache/gather_requests.h"

namespace render2mpeg::renderer {
namespace {

/// Of the points that records serve in a frame. chosen: 1 %, but as many as to tell something, and no more than settle
/// the error scale within some frames, nor, once that has happened, than hold it; not tuned.
constexpr double share_held_out = 0.01, least_held_out = 64, most_held_out = 256, most_held_out_later = 96;

/// Of few that records serve, not so many that serving were in vain.
constexpr double largest_share = 0.25;

/// They are gathered so much finer than their tolerance, else a cut's own errors would count as the records'. chosen:
/// 3, at which errors of 0.4 tolerances, root of the mean square, seem 0.42.
constexpr float finer = 3.0f;

/// So many times the errors that rays tell are no miss. chosen: 1.2 of 0 to 3 (docs/measurements.md#irradiance-cache,
/// "Hold-out validation").
constexpr float errors_of_chance = 1.2f;

constexpr std::uint64_t hold_out_seed = 0x7a1c;  ///< of core::uniform

/// Points chosen at random among those that records serve, by tile.
struct Choice {
    std::vector<std::vector<PointRef>> points;
    float served_share = 0;  ///< of the points that have queried so far
};

/// By how much more records are off than chance explains, as it is noticed; cuts err by no chance.
float off_beyond_chance(glm::vec3 difference, const PointLight& truth, const PointLight& cached, bool by_rays) {
    const float off = core::noticed(difference);
    if (!by_rays) return off;
    const float chance = errors_of_chance * std::hypot(truth.error, cached.error);
    return core::sqrt_or_zero(off * off - chance * chance);
}

Choice choose(const FrameState& frame, HoldOut when, bool settled) {
    double served = 0, queried = 0;
    for (const TileState& tile : frame.tiles) {
        for (std::size_t i = 0; i < tile.state.size(); ++i) {
            queried += tile.state[i] != PointState::open ? 1 : 0;
            served += tile.is_served(i) ? 1 : 0;
        }
    }
    const double upper = settled ? most_held_out_later : most_held_out;
    const double wanted = when == HoldOut::early ? upper : std::clamp(share_held_out * served, least_held_out, upper);
    const auto share = static_cast<float>(std::min(core::divide_or(wanted, served, 0.0), largest_share));
    Choice choice{std::vector<std::vector<PointRef>>(frame.tiles.size()),
                  static_cast<float>(core::divide_or(served, queried, 0.0))};
    for (std::uint32_t t = 0; t < frame.tiles.size(); ++t) {
        const auto stream = static_cast<std::uint64_t>(frame.snapshot.frame) * frame.tiles.size() + t;
        for (std::uint32_t i = 0; i < frame.tiles[t].state.size(); ++i)
            if (frame.tiles[t].is_served(i) &&
                core::uniform(hold_out_seed, stream, i, when == HoldOut::early ? 1 : 0) < share)
                choice.points[t].push_back({t, i});
    }
    return choice;
}

}  // namespace

void hold_out(FrameState& frame, CacheValidation& validation, HoldOut when) {
    const Choice choice = choose(frame, when, validation.is_full());
    const float error_scale = frame.limits.error_scale;
    frame.limits.error_scale *= finer;
    frame.aim.finer = finer;
    std::vector<HeldOutPoint> points;
    for (const GatheredRequests& g : gather(frame, choice.points, 0)) {
        for (std::size_t k = 0; k < g.points.size(); ++k) {
            const PointRef& ref = g.points[k];
            const GatherPoint& p = frame.point(ref);
            TileState& tile = frame.tiles[ref.tile];
            const glm::vec3 truth = g.light[k].scattered(p), cached = tile.light[ref.index].scattered(p);
            const float allowed = tile.tolerance[ref.index].allows(core::luminance(truth));
            const float error = core::divide_or(
                off_beyond_chance(truth - cached, g.light[k], tile.light[ref.index], frame.rays != nullptr), allowed,
                0.0f);
            if (!g.light[k].capped && std::isfinite(error)) {
                points.push_back({tile.light[ref.index].cache_error, error, choice.served_share});
                ++frame.counts.held_out;
                frame.counts.missed += error > 1.0f ? 1 : 0;
            }
            --tile.served;
            keep(frame, g, k);
            tile.light[ref.index].held_out = true;
            tile.state[ref.index] = PointState::held_out;
        }
    }
    frame.limits.error_scale = error_scale;
    frame.aim.finer = 1;
    validation.learn(points);
    frame.errors.cache_error_scale = validation.cache_error_scale();
}

void reopen_doubtful(FrameState& frame) {
    for (TileState& tile : frame.tiles) {
        for (std::size_t i = 0; i < tile.state.size(); ++i) {
            if (!tile.is_served(i) && tile.state[i] != PointState::reused) continue;
            if (tile.light[i].cache_error * frame.errors.cache_error_scale > 1.0f) tile.reopen(i);
        }
    }
}

}  // namespace render2mpeg::renderer
