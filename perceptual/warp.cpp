#include "perceptual/warp.h"

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

/// Identity of a pixel's surface point, to be found again.
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

/// The mean about a position between the centres of pixel (x, y) and of (x + 1, y + 1), which may lie outside; beyond
/// the seam where the picture wraps.
template <class T>
T fetch(const core::Plane<T>& values, const core::Visible& there, int x, int y, glm::vec2 within, const Point& point,
        bool wraps) {
    T sum(0.0f);
    float weights = 0.0f;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float weight = (i == 0 ? 1.0f - within.x : within.x) * (j == 0 ? 1.0f - within.y : within.y);
            const int column = wraps ? (x + i + values.width()) % values.width() : x + i;
            const bool inside = column >= 0 && y + j >= 0 && column < values.width() && y + j < values.height();
            if (!(weight > 0.0f) || !inside || !shows(there, column, y + j, point)) continue;
            sum += weight * values.at(column, y + j);
            weights += weight;
        }
    return weights > 0.0f ? sum / weights : T(no_partner);
}

}  // namespace

template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const core::Visible& here,
                    const core::MotionField* motion) {
    EXPECTS(values.width() == there.width() && values.height() == there.height());
    EXPECTS(motion == nullptr || (motion->kind.width() == here.width() && motion->kind.height() == here.height() &&
                                  !motion->depth_in_reference.empty()));
    const auto right = static_cast<float>(values.width()), bottom = static_cast<float>(values.height());
    core::Plane<T> warped(here.width(), here.height(), T(no_partner));
    for (int y = 0; y < here.height(); ++y) {
        T* const out = warped.row(y);
        for (int x = 0; x < here.width(); ++x) {
            if (motion != nullptr && motion->kind.row(y)[x] == core::PixelClass::none) continue;
            const glm::vec2 vector = motion == nullptr ? glm::vec2(0.0f) : motion->vector.row(y)[x];
            glm::vec2 place = glm::vec2(static_cast<float>(x), static_cast<float>(y)) + vector;
            if (motion != nullptr) place.x = motion->column(place.x);
            // Written so that a position that is not a number is outside, too.
            if (!(place.x > -0.5f && place.x < right - 0.5f && place.y > -0.5f && place.y < bottom - 0.5f)) continue;
            const int left = static_cast<int>(place.x + 1.0f) - 1, top = static_cast<int>(place.y + 1.0f) - 1;
            const glm::vec2 within = place - glm::vec2(static_cast<float>(left), static_cast<float>(top));
            const float depth = motion == nullptr ? here.depth.row(y)[x] : motion->depth_in_reference.row(y)[x];
            out[x] = fetch(values, there, left, top, within,
                           {here.address.row(y)[x], here.geometric_normal.row(y)[x], here.material.row(y)[x],
                            here.kind.row(y)[x], depth},
                           motion != nullptr && motion->wraps);
        }
    }
    return warped;
}

template core::Plane<float> warp(const core::Plane<float>&, const core::Visible&, const core::Visible&,
                                 const core::MotionField*);
template core::Plane<glm::vec2> warp(const core::Plane<glm::vec2>&, const core::Visible&, const core::Visible&,
                                     const core::MotionField*);

}  // namespace render2mpeg::perceptual
