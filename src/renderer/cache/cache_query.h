#pragma once
// Interpolates light at a point from nearby records.
#include <optional>

#include "renderer/cache/irradiance_record.h"
#include "renderer/cut/point_light.h"

namespace render2mpeg::renderer {

/// A gather point that queries the cache.
struct CacheQuery {
    const GatherPoint& point;
    PointTolerance tolerance;
    glm::vec2 at{0};                              ///< on the picture, pixels
    float extent = 0;                             ///< of a pixel at the point, across the line of sight; world
    float receives = 0;                           ///< luminance of the pixel by unit of light from all around
    std::optional<glm::vec3> eye = std::nullopt;  ///< world; none: far away, all look along the point's direction
};

/// Where it lies, as records do.
inline SurfaceMark mark_of(const CacheQuery& q) {
    const SurfacePoint& p = q.point.point;
    return {q.at, 0, surface_of(p.address, p.back_side), p.position, p.geometric_normal, p.shading_normal};
}

/// How the error of an interpolation is estimated: factors.
struct CacheErrorModel {
    float residual = 1;           ///< of what records are off the plane by
    float step = 0.5f;            ///< of what light changes by up to the nearest record
    float noise = 1;              ///< of the records' own errors
    float reused = 1;             ///< of the errors of light of the last frame, which was lit with another error scale
    bool independent = false;     ///< records err each for itself, since rays found their light
    float cache_error_scale = 1;  ///< of the first two: learnt by hold-out validation (cache_validation.h)
};

/// The cache's answer.
struct CacheEstimate {
    bool valid = false;  ///< its estimated error is within the point's tolerance
    PointLight light;    ///< of the light trees' trees
    int radius = 0;      ///< pixels that were looked at to each side
    /// The record whose light that is, at its own place in the point's pixel; none where it is light at the point.
    std::optional<std::uint32_t> moved_to;
};

/// Light of a point by a weighted plane through its neighbours' records, the nearest that agree: radii of 1, 2, 4 and
/// 6 pixels in turn; where none do, that of the nearest record in its own pixel, at the place of that
/// (docs/model/irradiance-cache.md). Marks the records as used where it is valid.
CacheEstimate query_cache(const CacheQuery& query, const RecordGrid& grid, RecordStore& records,
                          const CacheErrorModel& model, std::int64_t frame);

}  // namespace render2mpeg::renderer
