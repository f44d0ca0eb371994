#include "renderer/cache/find_cells.h"

#include <algorithm>

#include "core/color.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// What shows one colour so much less than another hides that records disagree in it. chosen: 0.2, not tuned.
constexpr float least_colour = 0.2f;

bool shows_all_colours(glm::vec3 reflects) {
    return !(least_colour * std::max({reflects.x, reflects.y, reflects.z}) >
             std::min({reflects.x, reflects.y, reflects.z}));
}

/// A point of this pixel that is served with light of its own place, and shows it in all colours; on the surface of
/// `like` if there is one.
std::optional<CellCorner> served_corner(const FrameState& frame, int x, int y, const CellCorner* like) {
    const Seen& seen = frame.seen;
    if (x >= seen.visible.width() || y >= seen.visible.height()) return std::nullopt;
    const auto t = static_cast<std::size_t>(y / tile_size * seen.tiles_across() + x / tile_size);
    const auto pixel = static_cast<std::size_t>(y % tile_size * tile_size + x % tile_size);
    const TileState& tile = frame.tiles[t];
    for (std::size_t i = tile.firsts[pixel]; i < tile.firsts[pixel + 1]; ++i) {
        const GatherPoint& p = seen.tiles[t][i];
        const glm::vec3 reflects = p.weight * p.point.bsdf.diffuse;
        if (!tile.is_served(i) || p.point.bsdf.has_glossy() || !shows_all_colours(reflects)) continue;
        const auto query = frame.query_of(t, i);
        if (!query) continue;
        CellCorner c{mark_of(*query), query->extent, &tile.light[i], query->receives, core::luminance(reflects)};
        if (like != nullptr &&
            !on_one_surface(like->mark, c.mark, like->extent * glm::length(c.mark.at - like->mark.at), like->extent))
            continue;
        c.scattered = core::luminance(tile.light[i].scattered(p));
        c.allowed = tile.tolerance[i].allows(c.scattered);
        c.residual_factor = residual_factor(tile.tolerance[i], c.scattered, c.allowed);
        return c;
    }
    return std::nullopt;
}

}  // namespace

void find_cells(FrameState& frame, int side) {
    frame.grid.extend(frame.records.all(), frame.camera);
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        TileCells& cells = frame.tiles[t].cells;
        const int left = static_cast<int>(t) % frame.seen.tiles_across() * tile_size,
                  top = static_cast<int>(t) / frame.seen.tiles_across() * tile_size;
        for (int y = 0; y < tile_size; y += side) {
            for (int x = 0; x < tile_size; x += side) {
                if (cells.at(x, y) != nullptr) continue;
                std::array<CellCorner, 4> corners;
                bool found = true;
                for (int c = 0; c < 4 && found; ++c) {
                    const auto corner = served_corner(frame, left + x + c % 2 * side, top + y + c / 2 * side,
                                                      c > 0 ? &corners[0] : nullptr);
                    found = corner.has_value();
                    if (found) corners[static_cast<std::size_t>(c)] = *corner;
                }
                if (!found) continue;
                if (const auto cell =
                        InterpolationCell::between(corners, side, frame.grid, frame.records, frame.snapshot.frame))
                    cells.add(x, y, side, *cell);
            }
        }
    });
}

}  // namespace render2mpeg::renderer
