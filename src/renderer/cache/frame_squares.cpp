// Points between those of a coarser lattice: where these are served and agree, most of a picture is told without asking
// records for each.
#include <algorithm>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/cache/frame_lighting.h"

namespace render2mpeg::renderer {
namespace {

/// What shows one colour so much less than another hides that records disagree in it. chosen: 0.2, not tuned.
constexpr float least_colour = 0.2f;

float max(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}
float min(glm::vec3 v) {
    return std::min({v.x, v.y, v.z});
}

}  // namespace

/// A point of this pixel that is served with light of its own place, and shows it in all colours; on the surface of
/// `like` if there is one.
std::optional<SquareCorner> FrameLighting::served_corner(int x, int y, const SquareCorner* like) const {
    if (x >= seen_.visible.width() || y >= seen_.visible.height()) return std::nullopt;
    const auto t = static_cast<std::size_t>(y / tile_size * seen_.tiles_across() + x / tile_size);
    const auto pixel = static_cast<std::size_t>(y % tile_size * tile_size + x % tile_size);
    for (std::size_t i = firsts_[t][pixel]; i < firsts_[t][pixel + 1]; ++i) {
        const GatherPoint& p = seen_.tiles[t][i];
        const glm::vec3 reflects = p.weight * p.point.bsdf.diffuse;
        if (!is_served(t, i) || p.point.bsdf.has_glossy() || least_colour * max(reflects) > min(reflects)) continue;
        const auto query = query_of(t, i);
        if (!query) continue;
        SquareCorner c{{query->at, 0, surface_of(p.point.address, p.point.back_side), p.point.position,
                        p.point.geometric_normal, p.point.shading_normal},
                       query->extent,
                       &light_[t][i],
                       query->receives,
                       core::luminance(reflects)};
        if (like != nullptr &&
            !on_one_surface(like->mark, c.mark, like->extent * glm::length(c.mark.at - like->mark.at), like->extent))
            continue;
        c.scattered = core::luminance(light_[t][i].scattered(p));
        c.allowed = tolerances_[t][i].allows(c.scattered);
        c.doubts = record_doubt(tolerances_[t][i], c.scattered, c.allowed);
        return c;
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
                    const auto corner =
                        served_corner(left + x + c % 2 * side, top + y + c / 2 * side, c > 0 ? &corners[0] : nullptr);
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
