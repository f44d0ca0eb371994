#include "renderer/cache/temporal_reuse.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/color.h"
#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/cut/gather_groups.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

/// Luminance that is known of a point's pixel before its cut.
float known_luminance(const PointLight& light, const GatherPoint& p) {
    const float known = core::luminance(light.scattered(p));
    return std::isfinite(known) ? known : 0.0f;
}

/// Places within its pixel that a point's shadow rays leave.
std::uint32_t places_of(const GatherPoint& p) {
    return p.others + (p.more_places ? static_cast<std::uint32_t>(p.more_places->size()) : 0u);
}

/// Whether the light was gathered for the very same point, and at least as closely.
bool is_of(const LitPoint& before, const GatherPoint& p) {
    return before.address == p.point.address && before.outgoing == p.point.outgoing && before.weight == p.weight &&
           before.places >= places_of(p);
}

/// Room for what will be known of a tile.
TileState empty_tile(const GatherTile& points) {
    TileState tile;
    tile.light.assign(points.size(), {});
    tile.exact.assign(points.size(), {});
    tile.state.assign(points.size(), PointState::open);
    return tile;
}

/// What the left eye knows of the right one's points.
void ask_other_eye(FrameState& frame, std::size_t t) {
    const GatherTile& points = frame.seen().tiles[t];
    if (!frame.is_of(scene::Eye::single)) frame.tiles[t].shared.assign(points.size(), {});
    if (frame.other.is_empty()) return;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float depth = frame.camera().depth_of(points[i].point.position);
        frame.tiles[t].shared[i] = frame.other.at(points[i], frame.camera().pixel_extent(depth)).light;
    }
}

/// Shadows of a group's points, as both eyes share them.
class GroupShadows {
  public:
    GroupShadows(std::size_t lights, std::span<SharedLight> shared)
        : of_light_(shared.empty() ? 0 : lights), shared_(shared) {}

    std::span<LaneShadows> of_group(const GatherGroup& group) {
        std::ranges::fill(of_light_, LaneShadows());
        each(group, [](LaneShadows& lanes, int lane, SharedLight& point, std::uint32_t light) {
            if (((point.lit | point.dark) & light) != 0) lanes.set(lane, (point.lit & light) != 0);
        });
        return of_light_;
    }
    /// Gives points what was found.
    void give(const GatherGroup& group) {
        each(group, [](const LaneShadows& lanes, int lane, SharedLight& point, std::uint32_t light) {
            if ((lanes.lit >> lane & 1u) != 0) point.lit |= light;
            if ((lanes.dark >> lane & 1u) != 0) point.dark |= light;
        });
    }

  private:
    template <class Do>
    void each(const GatherGroup& group, Do go) {
        for (std::size_t l = 0; l < std::min(of_light_.size(), SharedLight::most_lights); ++l)
            for (std::size_t i = 0; i < group.points.size(); ++i)
                go(of_light_[l], static_cast<int>(i), shared_[group.points[i]], 1u << l);
    }

    std::vector<LaneShadows> of_light_;
    std::span<SharedLight> shared_;
};

/// Gathers the lights that are not clustered for all points of a tile.
void gather_exact(FrameState& frame, std::size_t t, ShadeCounts& counts) {
    const GatherTile& points = frame.seen().tiles[t];
    std::vector<PointLight>& exact = frame.tiles[t].exact;
    GroupShadows shadows(frame.context.light_trees.sharp_lights(), frame.tiles[t].shared);
    Gatherer gatherer(frame.context.light_trees, frame.context.tracer);
    GatherLanes lanes;
    GroupTolerance tolerance;
    tolerance.allocation = frame.allocation;
    GatheredLight gathered;
    for (const GatherGroup& group : group_points(points, frame.camera().position(), 1)) {
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < group.points.size(); ++i) pointers[i] = &points[group.points[i]];
        fill(lanes, std::span<const GatherPoint* const>(pointers, group.points.size()));
        lanes.set = 0;
        for (std::size_t i = 0; i < group.points.size(); ++i)
            tolerance.set(static_cast<int>(i), frame.tiles[t].tolerance[group.points[i]]);
        gatherer.gather_exact(lanes, Shadow::sharp, &tolerance, shadows.of_group(group), gathered);
        shadows.give(group);
        counts.shadow_rays += gathered.shadow_rays;
        counts.direct_clusters += group.points.size() * static_cast<std::uint64_t>(gathered.direct_clusters);
        for (std::size_t i = 0; i < group.points.size(); ++i)
            exact[group.points[i]] = point_light(gathered, static_cast<int>(i), *pointers[i]);
    }
}

/// Whether light of the last frame is still within a point's tolerance. Only another tolerance, or an error scale that
/// has risen since (`error_factor` > 1), asks that: else a still film would gather the same light again and again.
/// Capped light is asked by tolerances alone, since gathering it again changes nothing. A tolerance holds `held`
/// standard errors.
bool is_good_enough(const LitPoint& before, const PointTolerance& now, const GatherPoint& p, float error_factor,
                    float held) {
    const bool has_risen = error_factor > 1.0f && !before.trees.capped;
    if (now.part == before.tolerance.part && !has_risen) return true;
    return !(error_factor * held * before.trees.error.value >
             now.allows_noise(core::luminance(before.trees.scattered(p))));
}

/// Likewise light of suns with a size, which errs as far as they are sampled. `are_prices`: by what rays are worth.
bool are_suns_good_enough(const LitPoint& before, const PointTolerance& now, const GatherPoint& p, bool are_prices) {
    if (now.part == before.tolerance.part) return true;
    const float light = core::luminance(before.exact.scattered(p)), error = before.exact.error.value;
    return are_prices ? !(core::errors_of_noise * error > now.allows_noise(light))
                      : !(core::errors_of_one_in_hundred * error > now.allows_samples(light));
}

/// Reuses the light of a tile's points that are the very same as in the last frame. Whether all exact light is known by
/// that.
bool reuse(FrameState& frame, std::size_t t, const FrameHistory& history, float reused_error) {
    const GatherTile& points = frame.seen().tiles[t];
    if (history.tiles.size() != frame.tiles.size() || history.tiles[t].size() != points.size()) return false;
    TileState& tile = frame.tiles[t];
    const bool has_suns = frame.context.light_trees.has_sharp_lamps();
    const float held = frame.rays != nullptr ? core::errors_of_noise : core::errors_of_one_in_hundred;
    bool all = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const LitPoint& before = history.tiles[t][i];
        if (!is_of(before, p)) {
            all = false;
            continue;
        }
        PointTolerance now = tile.tolerance[i];
        all = all && (!has_suns || are_suns_good_enough(before, now, p, frame.allocation.typical > 0.0f));
        tile.exact[i] = before.exact;
        now.base += known_luminance(before.exact, p);
        if (!is_good_enough(before, now, p, reused_error, held)) continue;
        PointLight& light = tile.light[i];
        light = before.trees;
        light.error = reused_error * light.error;
        light.shared = reused_error * light.shared;
        light.direct_cut = light.indirect_cut = 0;
        light.served = true;
        light.age += static_cast<float>(frame.snapshot.frame - history.frame);
        tile.state[i] = PointState::reused;
        ++tile.served;
        // Whichever record may have served it is not forgotten.
        const glm::ivec2 pixel = frame.pixel_of(t, p);
        for (const SurfaceMark& m : frame.grid.row(pixel.y, pixel.x, pixel.x))
            frame.records.mark_used(m.record, frame.snapshot.frame);
    }
    return all;
}

/// Adds the parts of a point's light.
void add_up(FrameState& frame, std::size_t t, std::size_t i) {
    TileState& tile = frame.tiles[t];
    PointLight& light = tile.light[i];
    const PointLight& known = tile.exact[i];
    light.direct += known.direct;
    light.indirect += known.indirect;
    light.glossy += known.glossy;
    light.direct_cut += known.direct_cut;
    light.indirect_cut += known.indirect_cut;
    light.clamped += known.clamped;
    // Two gatherings err each for itself.
    light.error += known.error;
    light.shared += known.shared;
}

}  // namespace

void start(FrameState& frame, const FrameHistory& history, float reused_error) {
    frame.grid.build(frame.records.all(), frame.camera());
    std::vector<ShadeCounts> of_tile(frame.tiles.size());
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        const GatherTile& points = frame.seen().tiles[t];
        TileState& tile = frame.tiles[t];
        tile = empty_tile(points);
        tile.tolerance = point_tolerances(frame.context, t, frame.rays != nullptr);
        ask_other_eye(frame, t);
        const bool knows = reuse(frame, t, history, reused_error);
        if (!knows && frame.context.light_trees.has_exact()) gather_exact(frame, t, of_tile[t]);
        for (std::size_t i = 0; i < points.size(); ++i)
            tile.tolerance[i].base += known_luminance(tile.exact[i], points[i]);
    });
    for (const ShadeCounts& c : of_tile) frame.shade_counts.add(c);
}

void tell(const FrameState& frame, OtherEye& eye) {
    std::vector<std::vector<PointLight>> light;
    std::vector<std::vector<SharedLight>> shared;
    for (const TileState& tile : frame.tiles) {
        light.push_back(tile.light);
        shared.push_back(tile.shared);
    }
    eye.take(frame.seen(), frame.camera(), light, shared);
}

FrameLight finish(FrameState& frame, FrameHistory& history) {
    FrameLight light(frame.tiles.size());
    history.frame = frame.snapshot.frame;
    history.tiles.resize(frame.tiles.size());
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        TileState& tile = frame.tiles[t];
        history.tiles[t].clear();
        for (std::size_t i = 0; i < tile.light.size(); ++i) {
            const GatherPoint& p = frame.seen().tiles[t][i];
            history.tiles[t].push_back({p.point.address, p.point.outgoing, p.weight, places_of(p), tile.tolerance[i],
                                        tile.exact[i], tile.light[i]});
            add_up(frame, t, i);
        }
        light[t] = std::move(tile.light);
    });
    for (const TileState& tile : frame.tiles) {
        frame.counts.served += tile.served;
        frame.shade_counts.gather_points += tile.served;
    }
    return light;
}

}  // namespace render2mpeg::renderer
