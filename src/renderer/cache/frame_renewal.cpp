// Light that has changed: what older records are off by is measured on a lattice and carried to the rest.
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/frame_lighting.h"
#include "renderer/cache/record_change.h"

namespace render2mpeg::renderer {
namespace {

/// In which order a square of 4 x 4 pixels is gathered afresh, far from each other.
constexpr int renewal_order[16] = {0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};

}  // namespace

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
            if (x_of(t, p) % 4 != x0 || y_of(t, p) % 4 != y0 || p.point.bsdf.has_glossy() || !takes(p)) continue;
            const auto query = query_of(t, i);
            if (!query) continue;
            const RecordEstimate told = estimate(*query, map_, records_, trust_, snapshot_.frame);
            if (!told.holds || told.elsewhere) continue;
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
            state_[ref.tile][ref.index] = PointState::settled;
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

}  // namespace render2mpeg::renderer
