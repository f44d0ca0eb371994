#include "renderer/cache/frame_lighting.h"

#include <algorithm>

#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

/// On the coarser lattices an area of 64 x 64 pixels gathers only so many requests or more: fewer fill no packets, and
/// are asked again on the next. chosen: 128, the fastest of 0 to 128 (docs/fits/records.md).
constexpr std::size_t least_dense = 128;

/// Luminance that is known of a point's pixel before its cut; below 0 where things that move hide more than that.
float known_luminance(const PointLight& light, const GatherPoint& p) {
    const float known = core::luminance(light.scattered(p));
    return std::isfinite(known) ? known : 0.0f;
}

}  // namespace

void FrameLighting::gather_exact(std::size_t tile, ShadeCounts& counts) {
    const GatherTile& points = seen_.tiles[tile];
    Gatherer gatherer(parts_ != nullptr ? parts_->moving : light_trees_, tracer_);
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

/// Takes the light of points that are the very same as in the last frame. Whether all exact light is known by that, and
/// what dynamic objects change.
bool FrameLighting::recall(std::size_t t, const RecordCache::LitTiles& last, const MovedPoints& last_moved_points,
                           std::int64_t last_frame, bool moved) {
    const GatherTile& points = seen_.tiles[t];
    if (last.size() != seen_.tiles.size() || last[t].size() != points.size()) return false;
    bool all = !moved;
    auto elsewhere = last_moved_points[t].begin();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const RecordCache::LitPoint& before = last[t][i];
        if (before.address != p.point.address || before.outgoing != p.point.outgoing || before.weight != p.weight ||
            (moved && moves(p))) {
            all = false;
            continue;
        }
        exact_[t][i] = before.exact;
        PointTolerance now = tolerances_[t][i];
        now.base += known_luminance(before.exact, p);
        if (now.part != before.tolerance.part &&
            trust_.recalled * before.trees.error > now.allows(core::luminance(before.trees.scattered(p))))
            continue;
        light_[t][i] = before.trees;
        light_[t][i].error *= trust_.recalled;
        light_[t][i].direct_cut = light_[t][i].indirect_cut = 0;
        light_[t][i].served = true;
        light_[t][i].age += static_cast<float>(snapshot_.frame - last_frame);
        state_[t][i] = PointState::recalled;
        while (elsewhere != last_moved_points[t].end() && elsewhere->index < i) ++elsewhere;
        if (elsewhere != last_moved_points[t].end() && elsewhere->index == i) moved_points_[t].push_back(*elsewhere);
        ++served_[t];
        // Whoever may have served it is not forgotten.
        const int x = x_of(t, p), y = y_of(t, p);
        for (const RecordMark& m : map_.row(y, x, x)) records_.use(m.record, snapshot_.frame);
    }
    return all;
}

void FrameLighting::prepare(const core::ToleranceMap& tolerance, const RecordCache::LitTiles& last,
                            const MovedPoints& last_moved_points, std::int64_t last_frame, bool moved,
                            ShadeCounts& counts) {
    map_.build(records_.all(), camera_);
    std::vector<ShadeCounts> of_tile(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        const GatherTile& points = seen_.tiles[t];
        exact_[t].assign(points.size(), {});
        light_[t].assign(points.size(), {});
        firsts_[t].assign(tile_size * tile_size + 1, 0);
        for (const GatherPoint& p : points) ++firsts_[t][p.pixel + 1u];
        for (std::size_t k = 1; k < firsts_[t].size(); ++k) firsts_[t][k] += firsts_[t][k - 1];
        state_[t].assign(points.size(), PointState::open);
        tolerances_[t] = point_tolerances(seen_, t, tolerance);
        const bool knows = recall(t, last, last_moved_points, last_frame, moved);
        if (!knows && parts_ != nullptr) exact_[t].assign(points.size(), {});
        if (!knows && !whole_.exact.empty()) gather_exact(t, of_tile[t]);
        moving_[t].assign(points.size(), knows ? Moving::recalled : Moving::unknown);
        dynamic_objects_[t].assign(points.size(), {});
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
    const auto eye = camera_.perspective() ? std::optional(camera_.position()) : std::nullopt;
    // Where light is parted, what moves changes it at the point, not where it were moved to.
    return RecordQuery{p, tolerances_[t][i], on_picture->position, extent, receives(p), eye, parts_ == nullptr};
}

std::vector<PointRef> FrameLighting::wanting(std::size_t t, int lattice) {
    const GatherTile& points = seen_.tiles[t];
    std::vector<PointRef> requests;
    std::uint64_t served = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        if (state_[t][i] >= PointState::settled || x_of(t, p) % lattice != 0 || y_of(t, p) % lattice != 0) continue;
        if (takes(p)) {
            const auto query = state_[t][i] == PointState::open ? query_of(t, i) : std::nullopt;
            if (query) {
                const RecordSquare* square =
                    p.point.bsdf.has_glossy() ? nullptr : squares_[t].at(p.pixel % tile_size, p.pixel / tile_size);
                if (square != nullptr && square->tell(*query, trust_, light_[t][i])) {
                    state_[t][i] = PointState::between;
                    ++served;
                    continue;
                }
                const RecordEstimate found = estimate(*query, map_, records_, trust_, snapshot_.frame);
                state_[t][i] = !found.holds      ? PointState::in_vain
                               : found.elsewhere ? PointState::elsewhere
                                                 : PointState::settled;
                if (found.elsewhere) {
                    const Record& r = records_[*found.elsewhere];
                    const glm::vec3 here = p.point.outgoing,
                                    outgoing = query->eye ? core::normalize_or(*query->eye - r.position, here) : here;
                    moved_points_[t].push_back(
                        {static_cast<std::uint32_t>(i), r.position, r.geometric_normal, r.shading_normal, outgoing});
                }
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
    served_[t] += served;
    return requests;
}

std::optional<Record> FrameLighting::record(const GatheredRequests& g, std::size_t i) const {
    auto record = record_of(point(g.points[i]), g.light[i], g.lobes[i], limits_.error_scale, snapshot_.frame);
    if (record) record->set = g.sets[i];
    return record;
}

void FrameLighting::keep(const GatheredRequests& g, std::size_t i, RecordCounts& counts) {
    const PointRef& ref = g.points[i];
    light_[ref.tile][ref.index] = g.light[i];
    state_[ref.tile][ref.index] = PointState::settled;
    if (!takes(point(ref))) return;
    if (const auto found = record(g, i)) {
        records_.add(*found);
        ++counts.created;
    }
}

/// Lets the requests of some tiles find each other.
std::vector<std::vector<PointRef>> FrameLighting::by_area(const std::vector<std::vector<PointRef>>& of_tile) const {
    const int across = seen_.tiles_across(), areas = areas_across();
    const int down = (static_cast<int>(seen_.tiles.size()) + across - 1) / std::max(across, 1);
    std::vector<std::vector<PointRef>> of_area(
        static_cast<std::size_t>(areas * ((down + area_tiles - 1) / area_tiles)));
    for (std::size_t t = 0; t < of_tile.size(); ++t) {
        auto& list = of_area[area_of(t)];
        list.insert(list.end(), of_tile[t].begin(), of_tile[t].end());
    }
    return of_area;
}

/// Gathers, of areas of at least so many requests.
std::vector<GatheredRequests> FrameLighting::gather(const std::vector<std::vector<PointRef>>& of_tile,
                                                    std::size_t least, ShadeCounts& counts) const {
    std::vector<std::vector<PointRef>> of_area = by_area(of_tile);
    // A few scattered ones fill no packet: they wait for the finer lattice.
    for (auto& list : of_area)
        if (list.size() < least) list.clear();
    std::vector<GatheredRequests> found(of_area.size());
    parallel::for_each(of_area.size(), [&](std::size_t a) {
        const auto on_movers = std::stable_partition(of_area[a].begin(), of_area[a].end(),
                                                     [&](const PointRef& r) { return !moves(point(r)); });
        const std::vector<PointRef> moving(on_movers, of_area[a].end());
        of_area[a].erase(on_movers, of_area[a].end());
        gather_requests(light_trees_, tracer_, seen_, camera_.position(), tolerances_, limits_, trials_, of_area[a],
                        found[a]);
        gather_requests(whole_, tracer_, seen_, camera_.position(), tolerances_, limits_, trials_, moving, found[a]);
    });
    for (const GatheredRequests& g : found) counts.add(g.counts);
    return found;
}

/// New records have come to some areas: who asked in vain near them may ask again.
void FrameLighting::reopen(const std::vector<GatheredRequests>& of_area) {
    const int across = areas_across(), down = static_cast<int>(of_area.size()) / std::max(across, 1);
    const auto is_new = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < across && y < down &&
               !of_area[static_cast<std::size_t>(y * across + x)].points.empty();
    };
    for (std::size_t t = 0; t < state_.size(); ++t) {
        const auto area = static_cast<int>(area_of(t));
        bool near = false;
        for (int k = 0; k < 9; ++k) near = near || is_new(area % across + k % 3 - 1, area / across + k / 3 - 1);
        if (!near) continue;
        for (PointState& state : state_[t])
            if (state == PointState::in_vain) state = PointState::open;
    }
}

/// The lattice's points that are not known yet ask, and are gathered where they ask in vain.
void FrameLighting::fill_lattice(int lattice, ShadeCounts& counts, RecordCounts& record_counts) {
    map_.extend(records_.all(), camera_);
    std::vector<std::vector<PointRef>> of_tile(seen_.tiles.size());
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) { of_tile[t] = wanting(t, lattice); });
    const std::vector<GatheredRequests> found = gather(of_tile, lattice > 1 ? least_dense : 0, counts);
    for (const GatheredRequests& g : found)
        for (std::size_t i = 0; i < g.points.size(); ++i) keep(g, i, record_counts);
    reopen(found);
}

void FrameLighting::refine(RecordWatch& known, ShadeCounts& counts, RecordCounts& record_counts) {
    for (const int lattice : lattices) {
        // Those of the lattices before tell a film's first frame how far to trust the rest.
        if (lattice == 1 && !known.knows()) {
            watch(Watch::early, known, counts, record_counts);
            doubt_served();
        }
        fill_lattice(lattice, counts, record_counts);
        if (lattice > 1) find_squares(lattice);
    }
    const float trusted = trust_.strictness;
    watch(Watch::late, known, counts, record_counts);
    // No point is left behind that this frame would not serve and the next one would ask for anew.
    if (trust_.strictness > trusted) {
        doubt_served();
        fill_lattice(1, counts, record_counts);
    }
}

void FrameLighting::tell(LobeTrials& trials) const {
    for (std::size_t t = 0; t < light_.size(); ++t) {
        for (std::size_t i = 0; i < light_[t].size(); ++i) {
            const GatherPoint& p = seen_.tiles[t][i];
            if (state_[t][i] == PointState::recalled || !p.point.bsdf.has_glossy() || !takes(p)) continue;
            trials.note(p.point.material, 1, light_[t][i].served || light_[t][i].watched ? 1 : 0);
        }
    }
}

FrameLight FrameLighting::take(RecordCache::LitTiles& last, MovedPoints& moved, ShadeCounts& counts,
                               RecordCounts& record_counts) {
    for (auto& tile : moved_points_) {
        std::sort(tile.begin(), tile.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
        record_counts.moved += tile.size();
    }
    moved = std::move(moved_points_);
    last.resize(light_.size());
    for (std::size_t t = 0; t < light_.size(); ++t) {
        last[t].clear();
        record_counts.served += served_[t];
        counts.gather_points += served_[t];
        for (std::size_t i = 0; i < light_[t].size(); ++i) {
            PointLight& light = light_[t][i];
            const GatherPoint& p = seen_.tiles[t][i];
            record_counts.between += state_[t][i] == PointState::between ? 1 : 0;
            last[t].push_back({p.point.address, p.point.outgoing, p.weight, tolerances_[t][i], exact_[t][i], light});
            const PointLight& known = exact_[t][i];
            light.direct += known.direct;
            light.indirect += known.indirect;
            light.glossy += known.glossy;
            light.direct_cut += known.direct_cut;
            light.indirect_cut += known.indirect_cut;
            light.clamped += known.clamped;
            if (parts_ == nullptr) continue;
            // Two gatherings err each for itself.
            light.error = std::hypot(light.error, known.error);
            light.capped = light.capped || known.capped;
            light.parted = dynamic_objects_[t][i].scattered(p) != glm::vec3(0);
            light.direct = glm::max(light.direct, glm::vec3(0));
            light.indirect = glm::max(light.indirect, glm::vec3(0));
            light.glossy = glm::max(light.glossy, glm::vec3(0));
        }
    }
    return std::move(light_);
}

}  // namespace render2mpeg::renderer
