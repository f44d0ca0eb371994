#include "perceptual/carry.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::perceptual {
namespace {

/// Surfaces that differ by more are two. Only asked where the triangles differ. chosen: in the films of animations/ at
/// 3 frames' distance 1 % .. 10 % find the same partners but for 0.2 % of pixels; less tells a slanted floor's
/// neighbouring pixels apart.
constexpr float depth_reach = 0.05f;
/// Likewise for the cosine between normals, which turn with their objects between the pictures: 25 degrees.
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
    if (there.kind.at(x, y) != point.kind) return false;
    if (point.kind == core::PixelClass::sky) return true;
    const core::SurfaceAddress& address = there.address.at(x, y);
    if (address.object != point.address.object || there.material.at(x, y) != point.material) return false;
    if (address.primitive == point.address.primitive) return true;
    const float depth = there.depth.at(x, y);
    if (!(std::abs(depth - point.depth) <= depth_reach * point.depth)) return false;
    const core::PackedNormal normal = there.geometric_normal.at(x, y);
    return normal == point.normal || glm::dot(normal.unpack(), point.normal.unpack()) >= normal_reach;
}

/// The mean about a position in pixels, the centre of the upper left pixel being (0, 0).
float fetch(const core::Plane<float>& values, const core::Visible& there, glm::vec2 place, const Point& point) {
    const float left = std::floor(place.x), top = std::floor(place.y);
    const float across = place.x - left, down = place.y - top;
    const int x0 = static_cast<int>(left), y0 = static_cast<int>(top);
    float sum = 0.0f, weights = 0.0f;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float weight = (i == 0 ? 1.0f - across : across) * (j == 0 ? 1.0f - down : down);
            const int x = x0 + i, y = y0 + j;
            if (!(weight > 0.0f) || x < 0 || y < 0 || x >= values.width() || y >= values.height()) continue;
            if (!shows(there, x, y, point)) continue;
            sum += weight * values.at(x, y);
            weights += weight;
        }
    return weights > 0.0f ? sum / weights : no_partner;
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
            const float depth = motion == nullptr ? here.depth.at(x, y) : motion->depth_in_reference.at(x, y);
            carried.at(x, y) = fetch(values, there, place,
                                     {here.address.at(x, y), here.geometric_normal.at(x, y), here.material.at(x, y),
                                      here.kind.at(x, y), depth});
        }
    return carried;
}

}  // namespace render2mpeg::perceptual
