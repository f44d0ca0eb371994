// Points between those of the coarsest lattice: where records serve its corners and these agree, most of a picture is
// told without asking records for each.
#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/frame_lighting.h"

namespace render2mpeg::renderer {
/// A point of this pixel that records serve as light of its own place, on the surface of `like` if there is one.
std::optional<SquareCorner> FrameLighting::served_corner(int x, int y, const RecordMark* like) const {
    if (x >= seen_.visible.width() || y >= seen_.visible.height()) return std::nullopt;
    const auto t = static_cast<std::size_t>(y / tile_size * seen_.tiles_across() + x / tile_size);
    const auto pixel = static_cast<std::size_t>(y % tile_size * tile_size + x % tile_size);
    for (std::size_t i = firsts_[t][pixel]; i < firsts_[t][pixel + 1]; ++i) {
        const GatherPoint& p = seen_.tiles[t][i];
        const std::uint32_t surface = surface_of(p.point.address, p.point.back_side);
        if (!is_served(t, i) || p.point.bsdf.has_glossy() || (like != nullptr && like->surface != surface)) continue;
        const auto on_picture = camera_.project(p.point.position);
        if (!on_picture) continue;
        const float scattered = core::luminance(light_[t][i].scattered(p));
        const float extent = camera_.pixel_size() * (camera_.perspective() ? on_picture->depth : 1.0f);
        return SquareCorner{
            {on_picture->position, 0, surface, p.point.position, p.point.geometric_normal, p.point.shading_normal},
            extent,
            &light_[t][i],
            receives(p),
            scattered,
            tolerances_[t][i].allows(scattered)};
    }
    return std::nullopt;
}

/// Squares whose corners are those of a lattice, where no larger one is known.
void FrameLighting::find_squares(int side) {
    map_.extend(records_.all(), camera_);
    parallel::for_each(seen_.tiles.size(), [&](std::size_t t) {
        TileSquares& squares = squares_[t];
        const int left = static_cast<int>(t) % seen_.tiles_across() * tile_size,
                  top = static_cast<int>(t) / seen_.tiles_across() * tile_size;
        for (int y = 0; y < tile_size; y += side) {
            for (int x = 0; x < tile_size; x += side) {
                if (squares.at(x, y) != nullptr) continue;
                std::array<SquareCorner, 4> corners;
                bool found = true;
                for (int c = 0; c < 4 && found; ++c) {
                    const auto corner = served_corner(left + x + c % 2 * side, top + y + c / 2 * side,
                                                      c > 0 ? &corners[0].mark : nullptr);
                    found = corner.has_value();
                    if (found) corners[static_cast<std::size_t>(c)] = *corner;
                }
                if (!found) continue;
                if (const auto square = RecordSquare::of(corners, side, map_, records_, snapshot_.frame))
                    squares.add(x, y, side, *square);
            }
        }
    });
}

}  // namespace render2mpeg::renderer
