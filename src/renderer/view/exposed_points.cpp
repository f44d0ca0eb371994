#include "renderer/view/exposed_points.h"

#include <algorithm>

#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {

PointMerger::PointMerger(std::vector<TileExposure>& found, const Exposure& exposure, Frame& seen)
    : found_(found), seen_(seen), of_tile_(seen.tiles.size()), place_(found.size()), moved_(seen.tiles.size()) {
    for (std::uint32_t t = 0; t < found.size(); ++t) {
        place_[t].resize(found[t].points.size());
        for (std::uint32_t k = 0; k < found[t].points.size(); ++k) {
            NewPoint& p = found[t].points[k];
            const TileArea area = area_of(seen, p.tile);
            if (exposure.exposed.at(area.first.x + p.point.pixel % tile_size,
                                    area.first.y + p.point.pixel / tile_size) == 0) {
                p.tile = t;
                p.point.pixel = p.source;
            }
            of_tile_[p.tile].emplace_back(t, k);
        }
    }
}

void PointMerger::merge(std::size_t tile) {
    const GatherTile before = std::move(seen_.tiles[tile]);
    std::vector<Ref>& more = of_tile_[tile];
    std::stable_sort(more.begin(), more.end(),
                     [&](const auto& a, const auto& b) { return point(a).point.pixel < point(b).point.pixel; });
    GatherTile merged;
    std::size_t next = 0;
    std::vector<std::uint32_t>& moved = moved_[tile];
    moved.reserve(before.size());
    for (std::uint32_t i = 0; i <= before.size(); ++i) {
        const int pixel = i < before.size() ? before[i].pixel : tile_size * tile_size;
        while (next < more.size() && point(more[next]).point.pixel < pixel) add(more, next, merged);
        if (i == before.size()) break;
        moved.push_back(static_cast<std::uint32_t>(merged.size()));
        merged.push_back(before[i]);
    }
    seen_.tiles[tile] = GatherTile(merged);
}

std::pair<std::uint32_t, std::uint32_t> PointMerger::of(std::size_t found_in, const TileExposure::Part& part) const {
    if ((part.point & is_new) == 0) return {part.tile, moved_[part.tile][part.point]};
    const std::uint32_t k = part.point & ~is_new;
    return {found_[found_in].points[k].tile, place_[found_in][k]};
}

/// Adds the new points of one pixel.
void PointMerger::add(const std::vector<Ref>& more, std::size_t& next, GatherTile& merged) {
    const std::size_t first = merged.size();
    const std::uint16_t pixel = point(more[next]).point.pixel;
    for (; next < more.size() && point(more[next]).point.pixel == pixel; ++next) {
        const NewPoint& p = point(more[next]);
        Fragment fragment;
        fragment.point = p.point.point;
        fragment.path = p.point.path;
        const auto same = std::find_if(merged.begin() + static_cast<std::ptrdiff_t>(first), merged.end(),
                                       [&](const GatherPoint& g) { return same_surface(g, fragment, p.extent); });
        place_[more[next].first][more[next].second] = static_cast<std::uint32_t>(same - merged.begin());
        if (same != merged.end()) continue;
        merged.push_back(p.point);
        p.spread.fold_into(merged.back().point);
    }
}

}  // namespace render2mpeg::renderer
