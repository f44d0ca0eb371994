#include "renderer/cache/gather_requests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/shared_points.h"
#include "renderer/cut/gatherer.h"
#include "renderer/gather/frame_rays.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Requests of areas, by groups that share cuts.
std::vector<GatheredRequests> group_areas(const FrameState& frame, const std::vector<std::vector<PointRef>>& of_area) {
    std::vector<GatheredRequests> found(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) {
        GatheredRequests& g = found[a];
        std::uint32_t pool = 0;
        for (const RequestGroup& group : group_requests(frame.seen(), of_area[a], frame.camera().position())) {
            g.points.insert(g.points.end(), group.points.begin(), group.points.end());
            g.sets.resize(g.points.size(), static_cast<std::uint8_t>(group.set));
            g.pools.resize(g.points.size(), pool++);
        }
        g.light.resize(g.points.size());
        g.lobes.resize(g.points.size());
        g.rays.resize(g.points.size());
    });
    return found;
}

/// Luminance as a part of what a pixel is known to show; 0 of what is not finite.
float as_base(double luminance) {
    return luminance > 0.0 && luminance < 1e30 ? static_cast<float>(luminance) : 0.0f;
}

/// Points of a group: places in the lists of an area.
struct GroupRange {
    std::size_t area = 0, first = 0, end = 0;
};

std::vector<GroupRange> groups_of(const std::vector<GatheredRequests>& found) {
    std::vector<GroupRange> groups;
    for (std::size_t a = 0; a < found.size(); ++a)
        for (std::size_t i = 0; i < found[a].points.size(); ++i)
            if (i == 0 || found[a].pools[i] != found[a].pools[i - 1])
                groups.push_back({a, i, i + 1});
            else
                ++groups.back().end;
    return groups;
}

/// Luminance that pixels get of what rays found, about, for errors of cuts to hide in. First rays tell little of their
/// own point: the mean of its group does, unless it would be `most_over_own` times as much. chosen: 4; not tuned.
std::array<float, lane_count> known_of_rays(const GatherPoint* const (&receivers)[lane_count],
                                            std::span<const RayLight> rays) {
    constexpr double most_over_own = 4;
    std::array<double, lane_count> white{};
    double mean = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        white[i] = core::divide_or(shown_luminance(*receivers[i], rays[i].light), 1.0 * receives(*receivers[i]), 0.0);
        mean += white[i] / static_cast<double>(rays.size());
    }
    std::array<float, lane_count> known{};
    for (std::size_t i = 0; i < rays.size(); ++i)
        known[i] = as_base(std::min(mean, most_over_own * white[i]) * static_cast<double>(receives(*receivers[i])));
    return known;
}

/// Light of light trees.
void gather_trees_of(const FrameState& frame, const GroupRange& group, Gatherer& gatherer, GatheredRequests& g,
                     ShadeCounts& counts) {
    // Gather what uses the cache as a receiver that serves other textures, too.
    const std::size_t count = group.end - group.first;
    GatherPoint receivers[lane_count];
    const GatherPoint* pointers[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) {
        pointers[i] = &frame.point(g.points[group.first + std::min(i, count - 1)]);
        if (!uses_cache(*pointers[i])) continue;
        receivers[i] = plain_receiver(*pointers[i]);
        pointers[i] = &receivers[i];
    }
    const auto known = known_of_rays(pointers, std::span(g.rays).subspan(group.first, count));
    GroupTolerance tolerance;
    for (std::size_t i = 0; i < lane_count; ++i) {
        const PointRef& ref = g.points[group.first + std::min(i, count - 1)];
        PointTolerance own = frame.tiles[ref.tile].tolerance[ref.index];
        own.base += known[std::min(i, count - 1)];
        tolerance.set(static_cast<int>(i), own);
    }
    GatherLanes lanes;
    fill(lanes, std::span<const GatherPoint* const>(pointers, count));
    lanes.set = g.sets[group.first];
    GatheredLight gathered;
    gatherer.gather(lanes, tolerance, frame.limits, gathered);

    // Hand out what was found.
    counts.add(gathered, count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto lane = static_cast<int>(i);
        PointLight light = point_light(gathered, lane, *pointers[i]);
        // The clamp took from the receiver what it is to have taken from the point, by share.
        light.clamped *= core::divide_or(core::luminance(light.scattered(frame.point(g.points[group.first + i]))),
                                         core::luminance(light.scattered(*pointers[i])), 0.0f);
        g.light[group.first + i] = light;
        const SurfacePoint& p = pointers[i]->point;
        if (p.bsdf.has_glossy())
            g.lobes[group.first + i] = {p.bsdf.alpha, p.outgoing, gathered.f0.at(lane), gathered.schlick.at(lane)};
    }
}

/// Groups of points that one task gathers: where there are many lamps one takes milliseconds.
constexpr std::size_t groups_at_once = 4;

void gather_trees(FrameState& frame, std::vector<GatheredRequests>& found) {
    const std::vector<GroupRange> groups = groups_of(found);
    std::vector<ShadeCounts> counts((groups.size() + groups_at_once - 1) / groups_at_once);
    parallel::for_ranges(groups.size(), groups_at_once, [&](std::size_t first, std::size_t end) {
        Gatherer gatherer(frame.context.light_trees, frame.context.tracer);
        for (std::size_t i = first; i < end; ++i)
            gather_trees_of(frame, groups[i], gatherer, found[groups[i].area], counts[first / groups_at_once]);
    });
    for (const ShadeCounts& part : counts) frame.shade_counts.add(part);
}

/// Light that a record's rays have found, as that of its plain receiver.
RayLight light_of_rays(const IrradianceRecord& r, const GatherPoint& plain) {
    const float shown = receives(plain);
    return {r.by_rays, 0.0f, r.batch_variance * shown * shown, r.ray_count};
}

/// Requests of an area for rays.
struct RayRequests {
    std::vector<GatherPoint> receivers;  ///< of all its points
    std::vector<GatherRequest> requests;
    std::vector<std::uint32_t> of;  ///< points of these
};

/// The first rays of new records, all of other points. What a record's rays have found already is taken over.
RayRequests ray_requests_of(const FrameState& frame, GatheredRequests& g) {
    RayRequests out;
    out.receivers.reserve(g.points.size());
    for (std::size_t i = 0; i < g.points.size(); ++i) {
        const PointRef& ref = g.points[i];
        const GatherPoint& p = frame.point(ref);
        out.receivers.push_back(uses_cache(p) ? plain_receiver(p) : p);
        if (ref.record != PointRef::none) {
            g.rays[i] = light_of_rays(frame.records[ref.record], out.receivers.back());
            continue;
        }
        if (!uses_cache(p) && !wants_rays(p.point.bsdf, RaysOf::all)) continue;
        out.of.push_back(static_cast<std::uint32_t>(i));
        GatherRequest& r =
            out.requests.emplace_back(request_of(out.receivers.back(), frame.tiles[ref.tile].tolerance[ref.index],
                                                 frame.pixel_of(ref.tile, p), frame.camera()));
        r.pool = g.pools[i];
        if (!uses_cache(p)) continue;
        // The record's own place alone, to which pilots come back.
        out.receivers.back().others = 0;
        r.rays = pilot_rays;
    }
    return out;
}

/// Gathers the sky and indirect light by rays.
void gather_rays(FrameState& frame, std::vector<GatheredRequests>& found) {
    std::uint32_t first_pool = 0;
    for (GatheredRequests& g : found) {
        for (std::uint32_t& pool : g.pools) pool += first_pool;
        if (!g.pools.empty()) first_pool = g.pools.back() + 1;
    }
    std::vector<RayRequests> of_area(found.size());
    parallel::for_each(found.size(), [&](std::size_t a) { of_area[a] = ray_requests_of(frame, found[a]); });
    std::vector<GatherRequest> requests;
    for (const RayRequests& area : of_area) requests.insert(requests.end(), area.requests.begin(), area.requests.end());
    const std::vector<RayLight> rays = frame.rays->gather(requests, frame.allocation);
    auto of_point = rays.begin();
    for (std::size_t a = 0; a < found.size(); ++a)
        for (const std::uint32_t i : of_area[a].of) found[a].rays[i] = *of_point++;
}

}  // namespace

std::vector<std::vector<PointRef>> by_area(const FrameState& frame, const std::vector<std::vector<PointRef>>& of_tile) {
    std::vector<std::vector<PointRef>> of_area(frame.area_count());
    for (std::size_t t = 0; t < of_tile.size(); ++t) {
        auto& list = of_area[frame.area_of(t)];
        list.insert(list.end(), of_tile[t].begin(), of_tile[t].end());
    }
    return of_area;
}

std::vector<GatheredRequests> gather(FrameState& frame, const std::vector<std::vector<PointRef>>& of_tile,
                                     std::size_t least) {
    std::vector<std::vector<PointRef>> of_area = by_area(frame, of_tile);
    // A few scattered ones fill no packet: they wait for the finer lattice.
    for (auto& list : of_area)
        if (list.size() < least) list.clear();
    parallel::for_each(of_area.size(), [&](std::size_t a) { choose_gathered(frame, of_area[a]); });
    std::vector<GatheredRequests> found = group_areas(frame, of_area);
    if (frame.rays != nullptr) gather_rays(frame, found);
    gather_trees(frame, found);
    return found;
}

void gather_trees_again(FrameState& frame, std::span<const GatherPoint> receivers) {
    // Of one surface and set of representatives, in blocks of 8 x 8 pixels.
    struct Placed {
        std::uint32_t set, record;
        std::uint64_t surface;
        glm::ivec2 pixel;
        auto key() const { return std::tuple(set, surface, pixel.y >> 3, pixel.x >> 3, pixel.y, pixel.x, record); }
    };
    std::vector<Placed> placed;
    for (const SurfaceMark& m : frame.grid.marks())
        placed.push_back({frame.records[m.record].set, m.record, m.surface, glm::ivec2(glm::floor(m.at))});
    std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.key() < b.key(); });
    std::vector<std::span<const Placed>> groups;
    for (std::size_t first = 0, last = 0; first < placed.size(); first = last) {
        while (last < placed.size() && last - first < lane_count && placed[last].set == placed[first].set &&
               placed[last].surface == placed[first].surface)
            ++last;
        groups.push_back(std::span(placed).subspan(first, last - first));
    }
    parallel::for_ranges(groups.size(), groups_at_once, [&](std::size_t first, std::size_t end) {
        Gatherer gatherer(frame.context.light_trees, frame.context.tracer);
        for (std::size_t g = first; g < end; ++g) {
            const std::span<const Placed> group = groups[g];
            const GatherPoint* pointers[lane_count];
            GroupTolerance tolerance;
            for (std::size_t i = 0; i < lane_count; ++i) {
                const std::uint32_t record = group[std::min(i, group.size() - 1)].record;
                pointers[i] = &receivers[record];
                PointTolerance own = frame.records[record].tolerance;
                own.base += as_base(shown_luminance(receivers[record], frame.records[record].by_rays));
                tolerance.set(static_cast<int>(i), own);
            }
            GatherLanes lanes;
            fill(lanes, std::span<const GatherPoint* const>(pointers, group.size()));
            lanes.set = static_cast<int>(group.front().set);
            GatheredLight gathered;
            gatherer.gather(lanes, tolerance, frame.limits, gathered);
            for (std::size_t i = 0; i < group.size(); ++i) {
                const auto lane = static_cast<int>(i);
                const PointLight light = point_light(gathered, lane, *pointers[i]);
                IrradianceRecord& r = frame.records.change(group[i].record);
                r.direct = light.direct;
                r.indirect = light.indirect;
                if (r.lobe.alpha > 0.0f) r.lobe.f0 = gathered.f0.at(lane), r.lobe.schlick = gathered.schlick.at(lane);
                r.capped = light.capped;
                r.error = {core::divide_or(light.error.value, receives(*pointers[i]) * frame.limits.error_scale, 0.0f)};
            }
        }
    });
}

namespace {

/// Lobes' light lies at most so many times as far behind the surface as the eye is before it: as good as endlessly far.
constexpr float farthest_depth = 1000.0f;

/// How far behind a point the light that its record tells seems to lie: an irradiance is on the surface, a reflection
/// where a mirror that is bent as the points of its pool would show it; between them by luminance.
float depth_behind(const FrameState& frame, const GatheredRequests& g, std::size_t i) {
    const GatherPoint& p = frame.point(g.points[i]);
    const glm::vec3 at = p.point.position;
    float bent = 0, square = 0;
    const auto compare = [&](std::size_t k) {
        const SurfacePoint& other = frame.point(g.points[k]).point;
        bent += glm::dot(other.shading_normal - p.point.shading_normal, other.position - at);
        square += glm::dot(other.position - at, other.position - at);
    };
    for (std::size_t k = i; k-- > 0 && g.pools[k] == g.pools[i];) compare(k);
    for (std::size_t k = i + 1; k < g.points.size() && g.pools[k] == g.pools[i]; ++k) compare(k);
    PointLight light;
    add(g.rays[i], p, light);
    const float farthest = farthest_depth * glm::distance(frame.camera().position(), at),
                nearness = g.rays[i].nearness + 2.0f * core::divide_or(bent, square, 0.0f),
                share = core::divide_or(core::luminance(p.weight * light.glossy), core::luminance(light.scattered(p)),
                                        0.0f);
    const float depth = share * (nearness * farthest > 1.0f ? 1.0f / nearness : farthest);
    return std::isfinite(depth) && depth > 0.0f ? depth : 0.0f;
}

/// Takes the light of one point; what its record is to be, if it uses the cache.
std::optional<IrradianceRecord> take(FrameState& frame, const GatheredRequests& g, std::size_t i) {
    const PointRef& ref = g.points[i];
    const GatherPoint& p = frame.point(ref);
    TileState& tile = frame.tiles[ref.tile];
    PointLight& light = tile.light[ref.index] = g.light[i];
    add(g.rays[i], p, light);
    tile.state[ref.index] = PointState::done;
    if (!uses_cache(p)) return std::nullopt;
    auto record = record_of(p, g.light[i], g.lobes[i], g.rays[i], frame.limits.error_scale, frame.snapshot.frame);
    if (!record) return std::nullopt;
    record->set = g.sets[i];
    record->seen_at = frame.middle_of(ref.tile, p);
    record->tolerance = tile.tolerance[ref.index];
    if (ref.record == PointRef::none) {
        record->numbers = request_of(p, {}, frame.pixel_of(ref.tile, p), frame.camera()).numbers;
        if (p.point.bsdf.has_lobe() && frame.camera().has_eye()) record->lobe.depth = depth_behind(frame, g, i);
        return record;
    }
    // Its rays stay what they are.
    const IrradianceRecord& before = frame.records[ref.record];
    record->born = before.born;
    record->lobe.depth = before.lobe.depth;
    record->numbers = before.numbers;
    record->next_ray = before.next_ray;
    record->known_rays = before.known_rays;
    record->pilot = before.pilot;
    record->is_pilot_now = before.is_pilot_now;
    record->baseline = before.baseline;
    return record;
}

}  // namespace

void keep(FrameState& frame, const std::vector<GatheredRequests>& found) {
    std::vector<std::vector<std::optional<IrradianceRecord>>> records(found.size());
    parallel::for_each(found.size(), [&](std::size_t a) {
        for (std::size_t i = 0; i < found[a].points.size(); ++i) records[a].push_back(take(frame, found[a], i));
    });
    for (std::size_t a = 0; a < found.size(); ++a) {
        for (std::size_t i = 0; i < records[a].size(); ++i) {
            if (!records[a][i]) continue;
            std::uint32_t index = found[a].points[i].record;
            if (index == PointRef::none) {
                index = frame.records.insert(std::move(*records[a][i]));
                ++frame.counts.created;
            } else {
                frame.records.change(index) = std::move(*records[a][i]);
            }
            frame.fresh.push_back({found[a].points[i], found[a].pools[i], index, found[a].light[i]});
        }
    }
}

}  // namespace render2mpeg::renderer
