#include "renderer/cache/gather_requests.h"

#include <algorithm>
#include <span>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

void gather_requests_of(const FrameState& frame, const RequestGroup& group, std::uint32_t pool, Gatherer& gatherer,
                        GatheredRequests& out) {
    // Gather what uses the cache as a receiver that serves other textures, too.
    GatherPoint receivers[lane_count];
    const GatherPoint* pointers[lane_count];
    GroupTolerance tolerance;
    for (std::size_t i = 0; i < lane_count; ++i) {
        const PointRef& ref = group.points[std::min(i, group.points.size() - 1)];
        tolerance.set(static_cast<int>(i), frame.tiles[ref.tile].tolerance[ref.index]);
        if (i >= group.points.size()) continue;
        pointers[i] = &frame.point(ref);
        if (!uses_cache(*pointers[i])) continue;
        receivers[i] = plain_receiver(*pointers[i]);
        pointers[i] = &receivers[i];
    }
    GatherLanes lanes;
    fill(lanes, std::span<const GatherPoint* const>(pointers, group.points.size()));
    lanes.set = group.set;
    GatheredLight gathered;
    gatherer.gather(lanes, tolerance, frame.limits, gathered);

    // Hand out what was found.
    out.counts.add(gathered, group.points.size());
    for (std::size_t i = 0; i < group.points.size(); ++i) {
        out.points.push_back(group.points[i]);
        const auto lane = static_cast<int>(i);
        PointLight light = point_light(gathered, lane, *pointers[i]);
        // The clamp took from the receiver what it is to have taken from the point, by share.
        light.clamped *= core::divide_or(core::luminance(light.scattered(frame.point(group.points[i]))),
                                         core::luminance(light.scattered(*pointers[i])), 0.0f);
        out.light.push_back(light);
        out.sets.push_back(static_cast<std::uint8_t>(group.set));
        out.pools.push_back(pool);
        out.lobes.emplace_back();
        out.rays.emplace_back();
        const SurfacePoint& p = pointers[i]->point;
        if (p.bsdf.has_glossy())
            out.lobes.back() = {p.bsdf.alpha, p.outgoing, gathered.f0.at(lane), gathered.schlick.at(lane)};
    }
}

/// Gathers the requests of one area, which share cuts.
void gather_area(const FrameState& frame, const std::vector<PointRef>& requests, GatheredRequests& out) {
    Gatherer gatherer(frame.light_trees, frame.tracer);
    for (const RequestGroup& group : group_requests(frame.seen, requests, frame.camera.position()))
        gather_requests_of(frame, group, out.pools.empty() ? 0 : out.pools.back() + 1, gatherer, out);
}

/// Gathers the sky and indirect light by rays: the first rays of records, all of other points.
void gather_rays(FrameState& frame, std::vector<GatheredRequests>& found) {
    std::vector<GatherRequest> requests;
    std::vector<GatherPoint> receivers;
    std::size_t count = 0;
    for (const GatheredRequests& g : found) count += g.points.size();
    receivers.reserve(count);
    std::uint32_t first_pool = 0;
    for (GatheredRequests& g : found) {
        for (std::size_t i = 0; i < g.points.size(); ++i) {
            const PointRef& ref = g.points[i];
            const GatherPoint& p = frame.point(ref);
            receivers.push_back(uses_cache(p) ? plain_receiver(p) : p);
            GatherRequest& r =
                requests.emplace_back(request_of(receivers.back(), frame.tiles[ref.tile].tolerance[ref.index],
                                                 frame.pixel_of(ref.tile, p), frame.camera));
            r.pool = g.pools[i] += first_pool;
            if (!uses_cache(p)) continue;
            r.rays = first_rays;
            r.keeps = frame.keeps_rays;
        }
        if (!g.pools.empty()) first_pool = g.pools.back() + 1;
    }
    const std::vector<RayLight> rays = frame.rays->gather(requests, frame.aim);
    std::size_t k = 0;
    for (GatheredRequests& g : found)
        for (std::size_t i = 0; i < g.points.size(); ++i, ++k) {
            g.rays[i] = rays[k];
            if (!rays[k].kept) continue;
            KeptRays& kept = *rays[k].kept;
            kept.receiver = receivers[k];
            kept.tolerance = requests[k].tolerance;
            kept.set = g.sets[i];
            kept.trees = {g.light[i].direct, g.light[i].indirect, g.lobes[i].f0, g.lobes[i].schlick};
        }
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
    std::vector<GatheredRequests> found(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) { gather_area(frame, of_area[a], found[a]); });
    if (frame.rays != nullptr) gather_rays(frame, found);
    for (const GatheredRequests& g : found) frame.shade_counts.add(g.counts);
    return found;
}

void gather_trees_again(const LightTrees& trees, const RayTracer& tracer, const CutLimits& limits,
                        std::span<KeptRays* const> kept) {
    std::vector<std::span<KeptRays* const>> groups;
    for (std::size_t first = 0, last = 0; first < kept.size(); first = last) {
        while (last < kept.size() && last - first < lane_count && kept[last]->pool == kept[first]->pool) ++last;
        groups.push_back(kept.subspan(first, last - first));
    }
    parallel::for_ranges(groups.size(), 16, [&](std::size_t first, std::size_t end) {
        Gatherer gatherer(trees, tracer);
        for (std::size_t g = first; g < end; ++g) {
            const std::span<KeptRays* const> group = groups[g];
            const GatherPoint* pointers[lane_count];
            GroupTolerance tolerance;
            for (std::size_t i = 0; i < lane_count; ++i) {
                const KeptRays& r = *group[std::min(i, group.size() - 1)];
                tolerance.set(static_cast<int>(i), r.tolerance);
                pointers[i] = &r.receiver;
            }
            GatherLanes lanes;
            fill(lanes, std::span<const GatherPoint* const>(pointers, group.size()));
            lanes.set = group.front()->set;
            GatheredLight gathered;
            gatherer.gather(lanes, tolerance, limits, gathered);
            for (std::size_t i = 0; i < group.size(); ++i) {
                const auto lane = static_cast<int>(i);
                const PointLight light = point_light(gathered, lane, *pointers[i]);
                const bool lobe = pointers[i]->point.bsdf.has_glossy();
                const std::array<glm::vec3, 4> now = {light.direct, light.indirect,
                                                      lobe ? gathered.f0.at(lane) : glm::vec3(0),
                                                      lobe ? gathered.schlick.at(lane) : glm::vec3(0)};
                for (std::size_t k = 0; k < now.size(); ++k) group[i]->tree_change[k] = now[k] - group[i]->trees[k];
                group[i]->trees = now;
            }
        }
    });
}

void keep(FrameState& frame, const GatheredRequests& g, std::size_t i) {
    const PointRef& ref = g.points[i];
    const GatherPoint& p = frame.point(ref);
    TileState& tile = frame.tiles[ref.tile];
    PointLight& light = tile.light[ref.index] = g.light[i];
    add(g.rays[i], p, light);
    tile.state[ref.index] = PointState::done;
    if (!uses_cache(p)) return;
    auto record = record_of(p, g.light[i], g.lobes[i], g.rays[i], frame.limits.error_scale, frame.snapshot.frame);
    if (!record) return;
    record->set = g.sets[i];
    frame.fresh.push_back({ref, g.pools[i], frame.records.insert(*record), g.light[i]});
    ++frame.counts.created;
}

}  // namespace render2mpeg::renderer
