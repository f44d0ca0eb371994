#include "perceptual/carry.h"

#include <algorithm>
#include <cmath>

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
float fetch(const core::Plane<float>& values, const core::Visible& there, int x, int y, glm::vec2 within,
            const Point& point) {
    float sum = 0.0f, weights = 0.0f;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float weight = (i == 0 ? 1.0f - within.x : within.x) * (j == 0 ? 1.0f - within.y : within.y);
            const bool inside = x + i >= 0 && y + j >= 0 && x + i < values.width() && y + j < values.height();
            if (!(weight > 0.0f) || !inside || !shows(there, x + i, y + j, point)) continue;
            sum += weight * values.at(x + i, y + j);
            weights += weight;
        }
    return weights > 0.0f ? sum / weights : no_partner;
}

/// Whether all four pixels about it show the triangle: the way most pixels go. Must lie inside.
bool all_show(const core::Visible& there, int x, int y, const core::SurfaceAddress& address) {
    const core::SurfaceAddress *upper = there.address.row(y) + x, *lower = there.address.row(y + 1) + x;
    const auto same = [&](const core::SurfaceAddress& a) {
        return a.primitive == address.primitive && a.object == address.object;
    };
    return address.is_surface() && same(upper[0]) && same(upper[1]) && same(lower[0]) && same(lower[1]);
}

float bilinear(const core::Plane<float>& values, int x, int y, glm::vec2 within) {
    const float *upper = values.row(y) + x, *lower = values.row(y + 1) + x;
    const float above = upper[0] + within.x * (upper[1] - upper[0]),
                below = lower[0] + within.x * (lower[1] - lower[0]);
    return above + within.y * (below - above);
}

}  // namespace

core::Plane<float> carry(const core::Plane<float>& values, const core::Visible& there, const core::Visible& here,
                         const core::MotionField* motion) {
    EXPECTS(values.width() == there.width() && values.height() == there.height());
    EXPECTS(motion == nullptr || (motion->kind.width() == here.width() && motion->kind.height() == here.height() &&
                                  !motion->depth_in_reference.empty()));
    const auto right = static_cast<float>(values.width()), bottom = static_cast<float>(values.height());
    core::Plane<float> carried(here.width(), here.height(), no_partner);
    for (int y = 0; y < here.height(); ++y)
        for (int x = 0; x < here.width(); ++x) {
            if (motion != nullptr && motion->kind.at(x, y) == core::PixelClass::none) continue;
            const glm::vec2 vector = motion == nullptr ? glm::vec2(0.0f) : motion->vector.at(x, y);
            const glm::vec2 place = glm::vec2(static_cast<float>(x), static_cast<float>(y)) + vector;
            // Written so that a position that is not a number is outside, too.
            if (!(place.x > -0.5f && place.x < right - 0.5f && place.y > -0.5f && place.y < bottom - 0.5f)) continue;
            const int left = static_cast<int>(place.x + 1.0f) - 1, top = static_cast<int>(place.y + 1.0f) - 1;
            const glm::vec2 within = place - glm::vec2(static_cast<float>(left), static_cast<float>(top));
            const bool inside = left >= 0 && top >= 0 && left + 1 < values.width() && top + 1 < values.height();
            if (inside && all_show(there, left, top, here.address.at(x, y))) {
                carried.at(x, y) = bilinear(values, left, top, within);
                continue;
            }
            const float depth = motion == nullptr ? here.depth.at(x, y) : motion->depth_in_reference.at(x, y);
            carried.at(x, y) = fetch(values, there, left, top, within,
                                     {here.address.at(x, y), here.geometric_normal.at(x, y), here.material.at(x, y),
                                      here.kind.at(x, y), depth});
        }
    return carried;
}

}  // namespace render2mpeg::perceptual
