#include "renderer/record_cache.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut.h"
#include "renderer/gather_groups.h"
#include "renderer/record_change.h"
#include "renderer/record_gather.h"

namespace render2mpeg::renderer {
namespace {

/// Lattices on which points that no record serves become records, the coarsest first.
constexpr int lattices[] = {4, 2, 1};

/// On the coarser lattices an area of 64 x 64 pixels gathers only so many requests or more: fewer fill no packets, and
/// are asked again on the next. chosen: of 0, 24, 48, 64 and 128 that with which later frames of Sponza's walk take
/// least time (a fifth less than 0).
constexpr std::size_t least_dense = 128;

/// Luminance that is known of a point's pixel before its cut.
float known_luminance(const PointLight& light, const GatherPoint& p) {
    const float known = core::luminance(light.scattered(p));
    return std::isfinite(known) ? std::max(known, 0.0f) : 0.0f;
}

/// In which order a square of 4 x 4 pixels is gathered afresh, far from each other.
constexpr int renewal_order[16] = {0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};

class FrameLighting {
  public:
    FrameLighting(const LightForest& forest, const RayTracer& tracer, const Seen& seen, const scene::Snapshot& snapshot,
                  const CutLimits& limits, const RecordTrust& trust, Records& records)
        : forest_(forest),
          tracer_(tracer),
          seen_(seen),
          snapshot_(snapshot),
          camera_(snapshot.camera),
          limits_(limits),
          trust_(trust),
          records_(records),
          map_(seen.visible.width(), seen.visible.height()),
          exact_(seen.tiles.size()),
          light_(seen.tiles.size()),
          tolerances_(seen.tiles.size()),
          gathered_(seen.tiles.size()),
          served_(seen.tiles.size(), 0) {
        limits_.exact = false;
        // Records keep their errors without caution, which is learnt anew at a cut.
        trust_.noise *= limits.caution;
    }

    void prepare(const core::ToleranceMap& tolerance, const RecordCache::LitTiles& last, std::int64_t last_frame,
                 ShadeCounts& counts);
    void renew(ShadeCounts& counts, RecordCounts& record_counts);
    void refine(int lattice, ShadeCounts& counts, RecordCounts& record_counts);
    void thin() { records_.thin(snapshot_.frame, map_); }
    FrameLight take(RecordCache::LitTiles& last, ShadeCounts& counts, RecordCounts& record_counts);

  private:
    bool recall(std::size_t tile, const RecordCache::LitTiles& last, std::int64_t last_frame);
    void gather_exact(std::size_t tile, ShadeCounts& counts);
    std::optional<RecordQuery> query_of(std::size_t tile, std::size_t point) const;
    std::vector<PointRef> wanting(std::size_t tile, int lattice);
    std::vector<GatheredRequests> gather(const std::vector<std::vector<PointRef>>& of_tile, std::size_t least,
                                         ShadeCounts& counts) const;
    std::optional<Record> record(const GatheredRequests& gathered, std::size_t i) const;
    void keep(const GatheredRequests& gathered, std::size_t i, RecordCounts& counts);
    int x_of(std::size_t tile, const GatherPoint& p) const {
        return static_cast<int>(tile) % seen_.tiles_across() * tile_size + p.pixel % tile_size;
    }
    int y_of(std::size_t tile, const GatherPoint& p) const {
        return static_cast<int>(tile) / seen_.tiles_across() * tile_size + p.pixel / tile_size;
    }
    const GatherPoint& point(const PointRef& r) const { return seen_.tiles[r.tile][r.index]; }

    const LightForest& forest_;
    const RayTracer& tracer_;
    const Seen& seen_;
    const scene::Snapshot& snapshot_;
    const scene::Camera& camera_;
    CutLimits limits_;
    RecordTrust trust_;
    Records& records_;
    RecordMap map_;
    FrameLight exact_, light_;  ///< of lights gathered exactly; of trees
    std::vector<std::vector<PointTolerance>> tolerances_;
    std::vector<std::vector<std::uint8_t>> gathered_;  ///< 1: this frame, for this very point
    std::vector<std::uint64_t> served_;                ///< by tile
};

void FrameLighting::gather_exact(std::size_t tile, ShadeCounts& counts) {
    const GatherTile& points = seen_.tiles[tile];
    Gatherer gatherer(forest_, tracer_);
    GatherLanes lanes;
    GatheredLight gathered;
    for (const GatherGroup& group : group_points(points, camera_.position(), 1)) {
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < group.points.size(); ++i) pointers[i] = &points[group.points[i]];
        fill(lanes, std::span<const GatherPoint* const>(pointers, group.points.size()));
        lanes.set = 0;
        gatherer.gather_exact(lanes, gathered);
        counts.shadow_rays += gathered.shadow_rays;
        counts.direct_clusters += group.points.size() * static_cast<std::uint64_t>(gathered.direct_clusters);
        for (std::size_t i = 0; i < group.points.size(); ++i)
            exact_[tile][group.points[i]] = point_light(gathered, static_cast<int>(i), *pointers[i]);
    }
}

/// Takes the light of points that are the very same as in the last frame. Whether all exact light is known by that.
bool FrameLighting::recall(std::size_t t, const RecordCache::LitTiles& last, std::int64_t last_frame) {
    const GatherTile& points = seen_.tiles[t];
    if (last.size() != seen_.tiles.size() || last[t].size() != points.size()) return false;
    bool all = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const RecordCache::LitPoint& before = last[t][i];
        if (before.address != p.point.address || before.outgoing != p.point.outgoing || before.weight != p.weight) {
            all = false;
            continue;
        }
        exact_[t][i] = before.exact;
        // It was within its tolerance then.
        PointTolerance now = tolerances_[t][i];
        now.base += known_luminance(before.exact, p);
        const bool finer = now.absolute < before.tolerance.absolute || now.relative < before.tolerance.relative;
        if (finer && before.trees.error > now.allows(core::luminance(before.trees.scattered(p)))) continue;
        light_[t][i] = before.trees;
        light_[t][i].direct_cut = light_[t][i].indirect_cut = 0;
        light_[t][i].served = true;
        light_[t][i].age += static_cast<float>(snapshot_.frame - last_frame);
        gathered_[t][i] = 1;
        ++served_[t];
        // Whoever may have served it is not forgotten.
        const int x = x_of(t, p), y = y_of(t, p);
        for (const RecordMark& m : map_.row(y, x, x)) records_.use(m.record, snapshot_.frame);
    }
    return all;
}

void FrameLighting::prepare(const core::ToleranceMap& tolerance, const RecordCache::LitTiles& last,
                            std::int64_t last_frame, ShadeCounts& counts) {
    map_.build(records_.all(), camera_);
    std::vector<ShadeCounts> of_tile(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        const GatherTile& points = seen_.tiles[t];
        exact_[t].assign(points.size(), {});
        light_[t].assign(points.size(), {});
        gathered_[t].assign(points.size(), 0);
        tolerances_[t] = point_tolerances(seen_, t, tolerance);
        if (!recall(t, last, last_frame) && !forest_.exact.empty()) gather_exact(t, of_tile[t]);
        for (std::size_t i = 0; i < points.size(); ++i)
            tolerances_[t][i].base += known_luminance(exact_[t][i], points[i]);
    });
    for (const ShadeCounts& c : of_tile) counts.add(c);
}

/// None for points that no picture shows, which does not happen but by rounding.
std::optional<RecordQuery> FrameLighting::query_of(std::size_t t, std::size_t i) const {
    const GatherPoint& p = seen_.tiles[t][i];
    const auto on_picture = camera_.project(p.point.position);
    if (!on_picture) return std::nullopt;
    const float extent = camera_.pixel_size() * (camera_.perspective() ? on_picture->depth : 1.0f);
    return RecordQuery{p, tolerances_[t][i], on_picture->position, extent, receives(p)};
}

std::vector<PointRef> FrameLighting::wanting(std::size_t t, int lattice) {
    const GatherTile& points = seen_.tiles[t];
    std::vector<PointRef> requests;
    std::uint64_t served = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const int x = x_of(t, p), y = y_of(t, p);
        if (gathered_[t][i] != 0 || x % lattice != 0 || y % lattice != 0) continue;
        if (takes_records(p)) {
            if (const auto query = query_of(t, i)) {
                const RecordEstimate found = estimate(*query, map_, records_, trust_, snapshot_.frame);
                if (found.holds) {
                    light_[t][i] = found.light;
                    ++served;
                    continue;
                }
            }
        } else if (lattice > 1) {
            continue;
        }
        requests.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(i)});
    }
    if (lattice == 1) served_[t] += served;
    return requests;
}

std::optional<Record> FrameLighting::record(const GatheredRequests& g, std::size_t i) const {
    auto record = record_of(point(g.points[i]), g.light[i], g.lobes[i], limits_.caution, snapshot_.frame);
    if (record) record->set = g.sets[i];
    return record;
}

void FrameLighting::keep(const GatheredRequests& g, std::size_t i, RecordCounts& counts) {
    const PointRef& ref = g.points[i];
    light_[ref.tile][ref.index] = g.light[i];
    gathered_[ref.tile][ref.index] = 1;
    if (!takes_records(point(ref))) return;
    if (const auto found = record(g, i)) {
        records_.add(*found);
        ++counts.created;
    }
}

/// Gathers, of areas of at least so many requests.
std::vector<GatheredRequests> FrameLighting::gather(const std::vector<std::vector<PointRef>>& of_tile,
                                                    std::size_t least, ShadeCounts& counts) const {
    // Let the requests of some tiles find each other.
    const int across = seen_.tiles_across(), areas = (across + area_tiles - 1) / area_tiles;
    const int down = (static_cast<int>(seen_.tiles.size()) + across - 1) / std::max(across, 1);
    std::vector<std::vector<PointRef>> of_area(
        static_cast<std::size_t>(areas * ((down + area_tiles - 1) / area_tiles)));
    for (std::size_t t = 0; t < of_tile.size(); ++t) {
        const int area = static_cast<int>(t) / across / area_tiles * areas + static_cast<int>(t) % across / area_tiles;
        auto& list = of_area[static_cast<std::size_t>(area)];
        list.insert(list.end(), of_tile[t].begin(), of_tile[t].end());
    }
    // A few scattered ones fill no packet: they wait for the finer lattice.
    for (auto& list : of_area)
        if (list.size() < least) list.clear();
    std::vector<GatheredRequests> found(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) {
        gather_requests(forest_, tracer_, seen_, camera_.position(), tolerances_, limits_, of_area[a], found[a]);
    });
    for (const GatheredRequests& g : found) counts.add(g.counts);
    return found;
}

/// Light has changed: looks at a lattice what older records would say, gathers that anew, and lets the older records
/// follow what they are off by.
void FrameLighting::renew(ShadeCounts& counts, RecordCounts& record_counts) {
    // Another place of the lattice with every frame, so that all is gathered afresh now and then.
    const auto turn = static_cast<std::uint64_t>(snapshot_.frame) % 16;
    const int x0 = renewal_order[turn] % 4, y0 = renewal_order[turn] / 4;
    std::vector<std::vector<PointRef>> of_tile(seen_.tiles.size());
    std::vector<std::vector<std::pair<std::uint32_t, PointLight>>> before(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        for (std::uint32_t i = 0; i < seen_.tiles[t].size(); ++i) {
            const GatherPoint& p = seen_.tiles[t][i];
            if (x_of(t, p) % 4 != x0 || y_of(t, p) % 4 != y0 || !takes_records(p) || p.point.bsdf.has_glossy())
                continue;
            const auto query = query_of(t, i);
            if (!query) continue;
            const RecordEstimate told = estimate(*query, map_, records_, trust_, snapshot_.frame);
            if (!told.holds) continue;
            of_tile[t].push_back({static_cast<std::uint32_t>(t), i});
            before[t].emplace_back(i, told.light);
        }
    });

    std::vector<LightChange> changes;
    std::vector<Record> fresh;
    for (const GatheredRequests& g : gather(of_tile, 0, counts)) {
        for (std::size_t k = 0; k < g.points.size(); ++k) {
            const PointRef& ref = g.points[k];
            const auto& tile = before[ref.tile];
            const auto told = std::lower_bound(tile.begin(), tile.end(), ref.index,
                                               [](const auto& entry, std::uint32_t i) { return entry.first < i; });
            light_[ref.tile][ref.index] = g.light[k];
            gathered_[ref.tile][ref.index] = 1;
            const auto found = record(g, k);
            if (!found) continue;
            const float allowed =
                tolerances_[ref.tile][ref.index].allows(core::luminance(g.light[k].scattered(point(ref))));
            changes.push_back({*found, told->second.direct, told->second.indirect,
                               core::divide_or(allowed, receives(point(ref)), 0.0f)});
            fresh.push_back(*found);
        }
    }
    record_counts.followed += follow(records_, map_, changes, camera_).changed;
    for (const Record& r : fresh) records_.add(r);
    record_counts.created += fresh.size();
    map_.build(records_.all(), camera_);
}

void FrameLighting::refine(int lattice, ShadeCounts& counts, RecordCounts& record_counts) {
    if (lattice != lattices[0]) map_.extend(records_.all(), camera_);
    std::vector<std::vector<PointRef>> of_tile(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) { of_tile[t] = wanting(t, lattice); });

    for (const GatheredRequests& g : gather(of_tile, lattice > 1 ? least_dense : 0, counts))
        for (std::size_t i = 0; i < g.points.size(); ++i) keep(g, i, record_counts);
}

FrameLight FrameLighting::take(RecordCache::LitTiles& last, ShadeCounts& counts, RecordCounts& record_counts) {
    last.resize(light_.size());
    for (std::size_t t = 0; t < light_.size(); ++t) {
        last[t].clear();
        record_counts.served += served_[t];
        counts.gather_points += served_[t];
        for (std::size_t i = 0; i < light_[t].size(); ++i) {
            PointLight& light = light_[t][i];
            const GatherPoint& p = seen_.tiles[t][i];
            last[t].push_back({p.point.address, p.point.outgoing, p.weight, tolerances_[t][i], exact_[t][i], light});
            light.direct += exact_[t][i].direct;
            light.glossy += exact_[t][i].glossy;
            light.direct_cut += exact_[t][i].direct_cut;
            light.clamped += exact_[t][i].clamped;
        }
    }
    return std::move(light_);
}

}  // namespace

void RecordCache::change(const scene::Snapshot& before, const scene::Snapshot& now) {
    last_ = {};
    changed_ = true;
    drop_disturbed(records_, before, now);
}

void RecordCache::cut_to(const Seen& seen, const scene::Snapshot& snapshot) {
    // Their errors are of another caution.
    last_ = {};
    RecordMap map(seen.visible.width(), seen.visible.height());
    map.build(records_.all(), snapshot.camera);
    records_.thin(snapshot.frame, map);
}

FrameLight RecordCache::light(const LightForest& forest, const RayTracer& tracer, const Seen& seen,
                              const scene::Snapshot& snapshot, const core::ToleranceMap& tolerance,
                              const CutLimits& limits, ShadeCounts& shade_counts, RecordCounts& counts) {
    EXPECTS(!tolerance.is_reference());
    if (snapshot.cut_before) cut_to(seen, snapshot);
    FrameLighting frame(forest, tracer, seen, snapshot, limits, trust_, records_);
    frame.prepare(tolerance, last_, last_frame_, shade_counts);
    last_frame_ = snapshot.frame;
    if (changed_ && records_.size() > 0) frame.renew(shade_counts, counts);
    changed_ = false;
    for (const int lattice : lattices) frame.refine(lattice, shade_counts, counts);
    frame.thin();
    counts.live = records_.size();
    return frame.take(last_, shade_counts, counts);
}

}  // namespace render2mpeg::renderer
