#include "perceptual/warp.h"

#include <bit>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::perceptual {
namespace {

/// Surfaces that differ by more are two. Only asked where the triangles differ. chosen: at 3
/// frames' distance 2 .. 10 % find the same partners for all but 0.04 % of pixels (cornell, colonnade, character); at 1
/// % slanted floors lose theirs, 0.4 % of the colonnade.
constexpr float depth_reach = 0.05f;
/// Likewise for the cosine between normals, which turn with their objects between the pictures: 25 degrees. chosen:
/// 0.97 loses the partners of 1.2 % of the colonnade's pixels, on round columns; 0.8 finds 0.4 % more, on corners.
constexpr float normal_reach = 0.9f;

/// What a pixel must find again.
struct Point {
    core::SurfaceAddress address;
    core::PackedNormal normal;
    std::uint32_t material;
    core::PixelClass kind;
    float depth;  ///< in the other picture
};

bool shows(const core::Visible& there, int x, int y, const Point& point) {
    // The same triangle is the same thing; most pixels end here.
    const core::SurfaceAddress& address = there.address.at(x, y);
    if (address.primitive == point.address.primitive && address.object == point.address.object && address.is_surface())
        return true;
    if (there.kind.at(x, y) != point.kind) return false;
    if (point.kind == core::PixelClass::sky) return true;
    if (address.object != point.address.object || there.material.at(x, y) != point.material) return false;
    const float depth = there.depth.at(x, y);
    if (!(std::abs(depth - point.depth) <= depth_reach * point.depth)) return false;
    const core::PackedNormal normal = there.geometric_normal.at(x, y);
    return normal == point.normal || glm::dot(normal.unpack(), point.normal.unpack()) >= normal_reach;
}

/// The mean about a position between the centres of pixel (x, y) and of (x + 1, y + 1), which may lie outside.
template <class T>
T fetch(const core::Plane<T>& values, const core::Visible& there, int x, int y, glm::vec2 within, const Point& point) {
    T sum(0.0f);
    float weights = 0.0f;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float weight = (i == 0 ? 1.0f - within.x : within.x) * (j == 0 ? 1.0f - within.y : within.y);
            const bool inside = x + i >= 0 && y + j >= 0 && x + i < values.width() && y + j < values.height();
            if (!(weight > 0.0f) || !inside || !shows(there, x + i, y + j, point)) continue;
            sum += weight * values.at(x + i, y + j);
            weights += weight;
        }
    return weights > 0.0f ? sum / weights : T(no_partner);
}

/// Hashes: two things have the same once in 10^9 comparisons, triangles of one object never. Not 0.
std::uint32_t triangle_of(const core::SurfaceAddress& address) {
    return (address.object * 0x9e3779b1u + 2 * address.primitive) | 1u;
}
std::uint32_t surface_of(const core::SurfaceAddress& address, std::uint32_t material, core::PackedNormal normal) {
    return (address.object * 0x9e3779b1u ^ material * 0x85ebca6bu ^
            std::bit_cast<std::uint32_t>(normal) * 0xc2b2ae35u) |
           1u;
}

/// What all four have: pixels x and x + 1 of two rows.
std::uint32_t common(const std::uint32_t* upper, const std::uint32_t* lower, int x) {
    const std::uint32_t own = upper[x];
    return ((upper[x + 1] ^ own) | (lower[x] ^ own) | (lower[x + 1] ^ own)) == 0 ? own : 0u;
}

template <class T>
T bilinear(const T* upper, const T* lower, glm::vec2 within) {
    const T above = upper[0] + within.x * (upper[1] - upper[0]), below = lower[0] + within.x * (lower[1] - lower[0]);
    return above + within.y * (below - above);
}

}  // namespace

Quads quads_of(const core::Visible& picture) {
    const int width = picture.width(), height = picture.height();
    Quads quads{core::Plane<std::uint32_t>(width, height), core::Plane<std::uint32_t>(width, height),
                core::Plane<float>(width, height), core::Plane<float>(width, height)};
    // Name each row's pixels once, and hold it against the row above.
    std::vector<std::uint32_t> triangles[2], surfaces[2];
    for (auto* names : {triangles, surfaces})
        for (int i = 0; i < 2; ++i) names[i].resize(static_cast<std::size_t>(width));
    for (int y = 0; y < height; ++y) {
        std::uint32_t *triangle = triangles[y % 2].data(), *surface = surfaces[y % 2].data();
        const core::SurfaceAddress* address = picture.address.row(y);
        const core::PackedNormal* normal = picture.geometric_normal.row(y);
        const std::uint32_t* material = picture.material.row(y);
        const core::PixelClass* kind = picture.kind.row(y);
        for (int x = 0; x < width; ++x) {
            const bool is_plain = address[x].is_surface() && kind[x] == core::PixelClass::surface;
            triangle[x] = address[x].is_surface() ? triangle_of(address[x]) : 0u;
            surface[x] = is_plain ? surface_of(address[x], material[x], normal[x]) : 0u;
        }
        if (y == 0) continue;
        const std::uint32_t *triangle_above = triangles[(y + 1) % 2].data(),
                            *surface_above = surfaces[(y + 1) % 2].data();
        const float *above = picture.depth.row(y - 1), *below = picture.depth.row(y);
        for (int x = 0; x + 1 < width; ++x) {
            quads.triangle.row(y - 1)[x] = common(triangle_above, triangle, x);
            quads.surface.row(y - 1)[x] = common(surface_above, surface, x);
        }
        float *nearest = quads.nearest.row(y - 1), *farthest = quads.farthest.row(y - 1);
        for (int x = 0; x + 1 < width; ++x) {
            nearest[x] = std::min(std::min(above[x], above[x + 1]), std::min(below[x], below[x + 1]));
            farthest[x] = std::max(std::max(above[x], above[x + 1]), std::max(below[x], below[x + 1]));
        }
    }
    return quads;
}

template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const core::Visible& here,
                    const core::MotionField* motion) {
    return warp(values, there, quads_of(there), here, motion);
}

template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const Quads& quads,
                    const core::Visible& here, const core::MotionField* motion) {
    EXPECTS(values.width() == there.width() && values.height() == there.height());
    EXPECTS(quads.triangle.width() == there.width() && quads.triangle.height() == there.height());
    EXPECTS(motion == nullptr || (motion->kind.width() == here.width() && motion->kind.height() == here.height() &&
                                  !motion->depth_in_reference.empty()));
    const auto right = static_cast<float>(values.width()), bottom = static_cast<float>(values.height());
    const auto width = static_cast<std::size_t>(values.width());
    core::Plane<T> warped(here.width(), here.height(), T(no_partner));
    for (int y = 0; y < here.height(); ++y) {
        T* const out = warped.row(y);
        for (int x = 0; x < here.width(); ++x) {
            if (motion != nullptr && motion->kind.row(y)[x] == core::PixelClass::none) continue;
            const glm::vec2 vector = motion == nullptr ? glm::vec2(0.0f) : motion->vector.row(y)[x];
            const glm::vec2 place = glm::vec2(static_cast<float>(x), static_cast<float>(y)) + vector;
            // Written so that a position that is not a number is outside, too.
            if (!(place.x > -0.5f && place.x < right - 0.5f && place.y > -0.5f && place.y < bottom - 0.5f)) continue;
            const int left = static_cast<int>(place.x + 1.0f) - 1, top = static_cast<int>(place.y + 1.0f) - 1;
            const glm::vec2 within = place - glm::vec2(static_cast<float>(left), static_cast<float>(top));
            const core::SurfaceAddress& address = here.address.row(y)[x];
            const core::PackedNormal normal = here.geometric_normal.row(y)[x];
            const std::uint32_t material = here.material.row(y)[x];
            const float depth = motion == nullptr ? here.depth.row(y)[x] : motion->depth_in_reference.row(y)[x];
            if (left >= 0 && top >= 0) {
                // Ask for both at once: which of them it is changes from pixel to pixel.
                const std::size_t k = static_cast<std::size_t>(top) * width + static_cast<std::size_t>(left);
                const float reach = depth_reach * depth;
                const int triangle = quads.triangle.values()[k] == triangle_of(address);
                const int surface =
                    static_cast<int>(quads.surface.values()[k] == surface_of(address, material, normal)) &
                    static_cast<int>(quads.nearest.values()[k] >= depth - reach) &
                    static_cast<int>(quads.farthest.values()[k] <= depth + reach) &
                    static_cast<int>(here.kind.row(y)[x] == core::PixelClass::surface);
                if ((triangle | surface) != 0) {
                    const T* const from = values.values().data() + k;
                    out[x] = bilinear(from, from + width, within);
                    continue;
                }
            }
            out[x] = fetch(values, there, left, top, within, {address, normal, material, here.kind.row(y)[x], depth});
        }
    }
    return warped;
}

template core::Plane<float> warp(const core::Plane<float>&, const core::Visible&, const core::Visible&,
                                 const core::MotionField*);
template core::Plane<float> warp(const core::Plane<float>&, const core::Visible&, const Quads&, const core::Visible&,
                                 const core::MotionField*);
template core::Plane<glm::vec2> warp(const core::Plane<glm::vec2>&, const core::Visible&, const Quads&,
                                     const core::Visible&, const core::MotionField*);

}  // namespace render2mpeg::perceptual
