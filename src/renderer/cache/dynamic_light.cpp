// What moving objects change of static light: gathered for a lattice of points, and interpolated between them where it
// changes little, so that records need not know of it (docs/model/dynamic-light.md).
#include "renderer/cache/dynamic_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/cache_lookup.h"
#include "renderer/cache/gather_requests.h"
#include "renderer/cut/gather_groups.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

/// Share of a point's tolerance that each part of dynamic light is gathered within. chosen: 0.25; at 0.12 no fewer
/// pixels are beyond their tolerance, and rays are a twentieth more.
constexpr float share_of_change = 0.25f;

/// Share of it by which the change at the corners of a square may differ where it is taken from them. chosen: 0.5; 0.25
/// takes 2 to 4 % more rays and leaves as many pixels beyond (docs/fits/records.md).
constexpr float share_between = 0.5f;

/// Where things hide so much that only this share of what a point was taken to tolerate is left, its light is asked for
/// anew. chosen: 0.7, not tuned.
constexpr float share_left = 0.7f;

/// Of the corners there must be so much, by weight, and all but one of four: the others show other surfaces. One alone
/// says nothing of what changes from it to the point, as at a dynamic object's foot. chosen: 0.5; where all are wanted,
/// twice as many points are gathered.
constexpr float least_found = 0.5f;

void add(PointLight& sum, const PointLight& part, float sign) {
    sum.direct += sign * part.direct;
    sum.indirect += sign * part.indirect;
    sum.glossy += sign * part.glossy;
    sum.clamped += sign * part.clamped;
    sum.direct_cut += part.direct_cut;
    sum.indirect_cut += part.indirect_cut;
    sum.error = std::hypot(sum.error, part.error);
    sum.capped = sum.capped || part.capped;
}

/// Nothing to gather but what every point gathers by itself.
bool is_empty(const LightTrees& light_trees) {
    return std::all_of(light_trees.lamps.begin(), light_trees.lamps.end(),
                       [](const WholeLamp& l) { return l.sharp; }) &&
           std::all_of(light_trees.trees.begin(), light_trees.trees.end(),
                       [](const LightTree& t) { return t.empty(); });
}

/// How alike points are between which dynamic light is interpolated.
constexpr Likeness one_surface{0.9f, 0.02f, 0.2f};

/// A point of this pixel on the same surface, whose dynamic light was gathered or may be taken for that.
std::optional<PointRef> corner(const FrameState& frame, int x, int y, const GatherPoint& like) {
    const Seen& seen = frame.seen;
    if (x >= seen.visible.width() || y >= seen.visible.height()) return std::nullopt;
    PointRef found{static_cast<std::uint32_t>(y / tile_size * seen.tiles_across() + x / tile_size), 0};
    const TileState& tile = frame.tiles[found.tile];
    const auto first = tile.firsts.begin() + (y % tile_size * tile_size + x % tile_size);
    for (found.index = first[0]; found.index < first[1]; ++found.index) {
        const GatherPoint& p = frame.point(found);
        const DynamicState known = tile.dynamic_state[found.index];
        if ((known == DynamicState::gathered || known == DynamicState::interpolated) && !p.point.bsdf.has_glossy() &&
            !frame.moves(p) && share_surface(p, like, frame.camera.position(), one_surface))
            return found;
    }
    return std::nullopt;
}

/// Interpolates a point's dynamic light between the corners of its cell of a lattice, if they differ by little.
bool interpolate(FrameState& frame, std::size_t t, std::size_t i, int lattice) {
    const GatherPoint& p = frame.seen.tiles[t][i];
    const glm::ivec2 pixel = frame.pixel_of(t, p);
    const int x0 = pixel.x - pixel.x % lattice, y0 = pixel.y - pixel.y % lattice;
    const float u = static_cast<float>(pixel.x % lattice) / static_cast<float>(lattice),
                v = static_cast<float>(pixel.y % lattice) / static_cast<float>(lattice);
    const std::array<float, 4> weights = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    PointLight mean;
    float whole = 0;
    glm::vec3 low(0), high(0);
    int corners = 0, found = 0;
    for (int k = 0; k < 4; ++k) {
        const float weight = weights[static_cast<std::size_t>(k)];
        if (weight == 0.0f) continue;
        ++corners;
        const auto ref = corner(frame, x0 + k % 2 * lattice, y0 + k / 2 * lattice, p);
        if (!ref) continue;
        const PointLight& there = frame.tiles[ref->tile].dynamic[ref->index];
        whole += weight;
        mean.direct += weight * there.direct;
        mean.indirect += weight * there.indirect;
        mean.error += weight * core::divide_or(there.error, receives(frame.point(*ref)), 0.0f) * receives(p);
        const glm::vec3 sent = there.scattered(p);
        low = found == 0 ? sent : glm::min(low, sent);
        high = found == 0 ? sent : glm::max(high, sent);
        ++found;
    }
    if (whole < least_found || found < std::min(corners, 3)) return false;
    mean.direct /= whole;
    mean.indirect /= whole;
    mean.error /= whole;
    TileState& tile = frame.tiles[t];
    if (!(std::max(core::noticed(high - low), mean.error) <= share_between * tile.allowed(p, i))) return false;
    tile.dynamic[i] = mean;
    tile.dynamic_state[i] = DynamicState::interpolated;
    return true;
}

/// The points of a lattice whose dynamic light no coarser lattice tells, by tile.
std::vector<std::vector<PointRef>> open_points(FrameState& frame, int lattice) {
    std::vector<std::vector<PointRef>> of_tile(frame.tiles.size());
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        for (std::uint32_t i = 0; i < frame.seen.tiles[t].size(); ++i) {
            const GatherPoint& p = frame.seen.tiles[t][i];
            if (frame.tiles[t].dynamic_state[i] != DynamicState::open || !frame.on_lattice(t, p, lattice)) continue;
            bool found = frame.moves(p);
            // What narrow lobes and mirrors show is as sharp as they are.
            for (const int coarser : lattices)
                if (!found && coarser > lattice && !p.point.bsdf.has_glossy() && !p.reached_by_specular())
                    found = interpolate(frame, t, i, coarser);
            if (!found) of_tile[t].push_back({static_cast<std::uint32_t>(t), i});
        }
    });
    return of_tile;
}

/// One of the dynamic parts of light.
struct Part {
    const LightTrees* light_trees;
    float sign;
};

/// Gathers all parts for one group of points, each by a cut of its own.
void gather_group(FrameState& frame, const RequestGroup& group, std::span<const Part> parts,
                  std::vector<Gatherer>& gatherers, ShadeCounts& counts) {
    GatherPoint receivers[lane_count];
    const GatherPoint* points[lane_count];
    GroupTolerance tolerance;
    for (std::size_t i = 0; i < lane_count; ++i) {
        const PointRef& ref = group.points[std::min(i, group.points.size() - 1)];
        const GatherPoint& p = frame.point(ref);
        const TileState& tile = frame.tiles[ref.tile];
        if (i < group.points.size()) {
            // What is taken for others, too, is gathered as records are: whatever the texture.
            receivers[i] = p.point.bsdf.has_glossy() ? p : plain_receiver(p);
            points[i] = &receivers[i];
        }
        const float light = core::luminance(tile.light[ref.index].scattered(p));
        tolerance.set(static_cast<int>(i), {{share_of_change * tile.allowed(p, ref.index), 0, 0},
                                            std::max(tile.tolerance[ref.index].base + light, 0.0f)});
    }
    GatherLanes lanes;
    fill(lanes, std::span<const GatherPoint* const>(points, group.points.size()));
    lanes.set = group.set;
    for (const PointRef& ref : group.points) frame.tiles[ref.tile].dynamic[ref.index] = {};
    CutLimits limits = frame.limits;
    limits.least = 1;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        GatheredLight gathered;
        gatherers[k].gather(lanes, tolerance, limits, gathered);
        counts.shadow_rays += gathered.shadow_rays;
        for (std::size_t i = 0; i < group.points.size(); ++i)
            add(frame.tiles[group.points[i].tile].dynamic[group.points[i].index],
                point_light(gathered, static_cast<int>(i), *points[i]), parts[k].sign);
    }
    for (const PointRef& ref : group.points) frame.tiles[ref.tile].dynamic_state[ref.index] = DynamicState::gathered;
}

void gather_dynamic(FrameState& frame, const std::vector<std::vector<PointRef>>& of_tile) {
    std::vector<Part> parts;
    for (const Part& p : {Part{&frame.split->moving, 1.0f}, Part{&frame.split->gained, 1.0f},
                          Part{&frame.split->lost, -1.0f}, Part{&frame.split->occluded, -1.0f}})
        if (!is_empty(*p.light_trees)) parts.push_back(p);
    const std::vector<std::vector<PointRef>> of_area = by_area(frame, of_tile);
    std::vector<ShadeCounts> counts(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) {
        std::vector<Gatherer> gatherers;
        for (const Part& p : parts) gatherers.emplace_back(*p.light_trees, frame.tracer);
        for (const RequestGroup& group : group_requests(frame.seen, of_area[a], frame.camera.position()))
            gather_group(frame, group, parts, gatherers, counts[a]);
    });
    for (const ShadeCounts& c : counts) frame.shade_counts.add(c);
}

/// Reopens points whose hidden share makes the gathered estimate too coarse for what is left; by tile.
std::vector<std::vector<PointRef>> reopen_hidden(FrameState& frame) {
    std::vector<std::vector<PointRef>> hidden(frame.tiles.size());
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        TileState& tile = frame.tiles[t];
        for (std::uint32_t i = 0; i < frame.seen.tiles[t].size(); ++i) {
            const GatherPoint& p = frame.seen.tiles[t][i];
            const float change = core::luminance(tile.dynamic[i].scattered(p));
            if (!(change < 0.0f) || frame.moves(p)) continue;
            const float before = tile.allowed(p, i);
            tile.tolerance[i].base += change;
            const float left = tile.allowed(p, i);
            if (left >= share_left * before) continue;
            hidden[t].push_back({static_cast<std::uint32_t>(t), i});
            const bool served = tile.is_served(i);
            // Its own cut may do all the same, what moves was gathered for more.
            if (!served && tile.light[i].error <= left) continue;
            if (served || tile.state[i] == PointState::reused) --tile.served;
            tile.state[i] = PointState::open;
            tile.light[i] = {};
        }
    });
    return hidden;
}

}  // namespace

void add_dynamic_light(FrameState& frame) {
    for (const int lattice : lattices) gather_dynamic(frame, open_points(frame, lattice));
    const std::vector<std::vector<PointRef>> hidden = reopen_hidden(frame);
    if (std::any_of(hidden.begin(), hidden.end(), [](const auto& list) { return !list.empty(); })) {
        light_lattice(frame, 1);
        gather_dynamic(frame, hidden);
    }
    for (TileState& tile : frame.tiles)
        for (std::size_t i = 0; i < tile.dynamic.size(); ++i) add(tile.exact[i], tile.dynamic[i], 1.0f);
}

}  // namespace render2mpeg::renderer
