#pragma once
// Interpolates light at a point from nearby records.
#include <optional>

#include "renderer/cache/irradiance_record.h"
#include "renderer/cut/point_light.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::renderer {

/// A gather point that queries the cache.
struct CacheQuery {
    const GatherPoint& point;
    PointTolerance tolerance;
    glm::vec2 at{0};                              ///< on the picture, pixels
    float extent = 0;                             ///< of a pixel at the point, across the line of sight; world
    float receives = 0;                           ///< luminance of the pixel by unit of light from all around
    std::optional<glm::vec3> eye = std::nullopt;  ///< world; none: far away, all look along the point's direction
    bool crowded = false;                         ///< worth fewer rays than a pilot has, by its share of its pixel
    bool priced = false;                          ///< its tolerance is a price, and no bound
    float other_error = 0;  ///< of the same light in the other eye's picture, luminance of the pixel; 0: not known
};

/// Where it lies, as records do.
inline SurfaceMark mark_of(const CacheQuery& q) {
    const SurfacePoint& p = q.point.point;
    return {
        q.at, 0, surface_of(p.address, p.back_side, q.point.path), p.position, p.geometric_normal, p.shading_normal};
}

/// Light of a point by its neighbours' records (local_regression.h), if its estimated error is within the tolerance, or
/// less than what rays of its own would be worth. Marks the records as used. `error_scale`: of cuts (CutLimits).
std::optional<PointLight> query_cache(const CacheQuery& query, const RecordGrid& grid, RecordStore& records,
                                      Allocation allocation, float error_scale, std::int64_t frame);

}  // namespace render2mpeg::renderer
