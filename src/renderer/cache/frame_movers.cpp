// What things that move change of the light of what is still: gathered for a lattice of points, and between them where
// it changes little, so that records need not know of it (light_parts.h).
#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/frame_lighting.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

/// Share of a point's tolerance that each part of the change is gathered within. chosen: 0.25; at 0.12 no fewer pixels
/// are beyond their tolerance, and rays are a twentieth more.
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

bool is_empty(const LightTrees& light_trees) {
    return std::all_of(light_trees.trees.begin(), light_trees.trees.end(),
                       [](const LightTree& t) { return t.empty(); });
}

}  // namespace

/// What a point's light may be off by, as far as it is known.
float FrameLighting::allowed(std::size_t t, std::size_t i) const {
    return tolerances_[t][i].allows(core::luminance(light_[t][i].scattered(seen_.tiles[t][i])));
}

/// A point of this pixel on the same surface, whose change was gathered or may be taken for that.
bool FrameLighting::corner(int x, int y, const GatherPoint& like, PointRef& found) const {
    if (x >= seen_.visible.width() || y >= seen_.visible.height()) return false;
    found.tile = static_cast<std::uint32_t>(y / tile_size * seen_.tiles_across() + x / tile_size);
    const int pixel = y % tile_size * tile_size + x % tile_size;
    const GatherTile& points = seen_.tiles[found.tile];
    const auto first = firsts_[found.tile].begin() + pixel;
    for (found.index = first[0]; found.index < first[1]; ++found.index) {
        const GatherPoint& p = points[found.index];
        const Moving known = moving_[found.tile][found.index];
        if ((known == Moving::gathered || known == Moving::between) && !p.point.bsdf.has_glossy() && !moves(p) &&
            share_surface(p, like, camera_.position()))
            return true;
    }
    return false;
}

/// Takes a point's change from the corners of its square of a lattice, if they differ by little.
bool FrameLighting::is_between(std::size_t t, std::size_t i, int lattice) {
    const GatherPoint& p = seen_.tiles[t][i];
    const int x = x_of(t, p), y = y_of(t, p);
    const int x0 = x - x % lattice, y0 = y - y % lattice;
    const float u = static_cast<float>(x % lattice) / static_cast<float>(lattice),
                v = static_cast<float>(y % lattice) / static_cast<float>(lattice);
    const std::array<float, 4> weights = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    PointLight mean;
    float whole = 0;
    glm::vec3 low(0), high(0);
    int corners = 0, found = 0;
    for (int k = 0; k < 4; ++k) {
        if (weights[static_cast<std::size_t>(k)] == 0.0f) continue;
        ++corners;
        PointRef ref;
        const float weight = weights[static_cast<std::size_t>(k)];
        if (!corner(x0 + k % 2 * lattice, y0 + k / 2 * lattice, p, ref)) continue;
        const PointLight& there = dynamic_objects_[ref.tile][ref.index];
        whole += weight;
        mean.direct += weight * there.direct;
        mean.indirect += weight * there.indirect;
        mean.error += weight * core::divide_or(there.error, receives(point(ref)), 0.0f) * receives(p);
        const glm::vec3 sent = there.scattered(p);
        low = found == 0 ? sent : glm::min(low, sent);
        high = found == 0 ? sent : glm::max(high, sent);
        ++found;
    }
    if (whole < least_found || found < std::min(corners, 3)) return false;
    mean.direct /= whole;
    mean.indirect /= whole;
    mean.error /= whole;
    if (!(std::max(core::noticed(high - low), mean.error) <= share_between * allowed(t, i))) return false;
    dynamic_objects_[t][i] = mean;
    moving_[t][i] = Moving::between;
    return true;
}

/// The points of a lattice that no coarser one tells.
std::vector<std::vector<PointRef>> FrameLighting::wanting_movers(int lattice) {
    std::vector<std::vector<PointRef>> of_tile(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        for (std::uint32_t i = 0; i < seen_.tiles[t].size(); ++i) {
            const GatherPoint& p = seen_.tiles[t][i];
            if (moving_[t][i] != Moving::unknown || x_of(t, p) % lattice != 0 || y_of(t, p) % lattice != 0) continue;
            bool found = moves(p);
            // What narrow lobes and mirrors show is as sharp as they are.
            for (const int coarser : lattices)
                if (!found && coarser > lattice && !p.point.bsdf.has_glossy() && !p.reached_by_specular)
                    found = is_between(t, i, coarser);
            if (!found) of_tile[t].push_back({static_cast<std::uint32_t>(t), i});
        }
    });
    return of_tile;
}

void FrameLighting::gather_movers(const std::vector<std::vector<PointRef>>& of_tile, ShadeCounts& counts) {
    struct Part {
        const LightTrees* light_trees;
        float sign;
    };
    std::vector<Part> parts;
    for (const Part& p : {Part{&parts_->moving, 1.0f}, Part{&parts_->gained, 1.0f}, Part{&parts_->lost, -1.0f},
                          Part{&parts_->hidden, -1.0f}})
        if (!is_empty(*p.light_trees)) parts.push_back(p);
    const std::vector<std::vector<PointRef>> of_area = by_area(of_tile);
    std::vector<ShadeCounts> counts_of(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) {
        std::vector<Gatherer> gatherers;
        for (const Part& p : parts) gatherers.emplace_back(*p.light_trees, tracer_);
        for (const RequestGroup& group : group_requests(seen_, of_area[a], camera_.position())) {
            GatherPoint receivers[lane_count];
            const GatherPoint* points[lane_count];
            GroupTolerance tolerance;
            for (std::size_t i = 0; i < lane_count; ++i) {
                const PointRef& ref = group.points[std::min(i, group.points.size() - 1)];
                if (i < group.points.size()) {
                    // What is taken for others, too, is gathered as records are: whatever the texture.
                    receivers[i] = point(ref).point.bsdf.has_glossy() ? point(ref) : plain_receiver(point(ref));
                    points[i] = &receivers[i];
                }
                const PointTolerance& whole = tolerances_[ref.tile][ref.index];
                const float light = core::luminance(light_[ref.tile][ref.index].scattered(point(ref)));
                tolerance.set(static_cast<int>(i), {{share_of_change * allowed(ref.tile, ref.index), 0, 0},
                                                    std::max(whole.base + light, 0.0f)});
            }
            GatherLanes lanes;
            fill(lanes, std::span<const GatherPoint* const>(points, group.points.size()));
            lanes.set = group.set;
            for (const PointRef& ref : group.points) dynamic_objects_[ref.tile][ref.index] = {};
            for (std::size_t k = 0; k < parts.size(); ++k) {
                GatheredLight gathered;
                CutLimits limits = limits_;
                limits.least = 1;
                gatherers[k].gather(lanes, tolerance, limits, gathered);
                counts_of[a].shadow_rays += gathered.shadow_rays;
                for (std::size_t i = 0; i < group.points.size(); ++i)
                    add(dynamic_objects_[group.points[i].tile][group.points[i].index],
                        point_light(gathered, static_cast<int>(i), *points[i]), parts[k].sign);
            }
            for (const PointRef& ref : group.points) moving_[ref.tile][ref.index] = Moving::gathered;
        }
    });
    for (const ShadeCounts& c : counts_of) counts.add(c);
}

/// Points of which so much is hidden that what was gathered is too rough for what is left ask again; by tiles.
std::vector<std::vector<PointRef>> FrameLighting::doubt_hidden() {
    std::vector<std::vector<PointRef>> doubted(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        for (std::uint32_t i = 0; i < seen_.tiles[t].size(); ++i) {
            const GatherPoint& p = seen_.tiles[t][i];
            const float change = core::luminance(dynamic_objects_[t][i].scattered(p));
            if (!(change < 0.0f) || moves(p)) continue;
            const float before = allowed(t, i);
            tolerances_[t][i].base += change;
            const float left = allowed(t, i);
            const bool served = is_served(t, i);
            if (left >= share_left * before) continue;
            doubted[t].push_back({static_cast<std::uint32_t>(t), i});
            // Its own cut may do all the same, what moves was gathered for more.
            if (!served && light_[t][i].error <= left) continue;
            if (served || state_[t][i] == PointState::recalled) --served_[t];
            state_[t][i] = PointState::open;
            light_[t][i] = {};
        }
    });
    return doubted;
}

void FrameLighting::add_movers(ShadeCounts& counts, RecordCounts& record_counts) {
    for (const int lattice : lattices) gather_movers(wanting_movers(lattice), counts);
    const std::vector<std::vector<PointRef>> doubted = doubt_hidden();
    const auto any = [](const std::vector<PointRef>& list) { return !list.empty(); };
    if (std::any_of(doubted.begin(), doubted.end(), any)) {
        fill_lattice(1, counts, record_counts);
        gather_movers(doubted, counts);
    }
    for (std::size_t t = 0; t < dynamic_objects_.size(); ++t)
        for (std::size_t i = 0; i < dynamic_objects_[t].size(); ++i) add(exact_[t][i], dynamic_objects_[t][i], 1.0f);
}

}  // namespace render2mpeg::renderer
