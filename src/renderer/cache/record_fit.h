#pragma once
// Interpolates light at a point from nearby records: the cache lookup.
#include <optional>

#include "renderer/cache/records.h"
#include "renderer/cut/point_light.h"

namespace render2mpeg::renderer {

/// A gather point that asks its neighbours' records.
struct RecordQuery {
    const GatherPoint& point;
    PointTolerance tolerance;
    glm::vec2 at{0};                              ///< on the picture, pixels
    float extent = 0;                             ///< of a pixel at the point, across the line of sight; world
    float receives = 0;                           ///< luminance of the pixel by unit of light from all around
    std::optional<glm::vec3> eye = std::nullopt;  ///< world; none: far away, all look along the point's direction
    bool may_move = true;                         ///< light may be that of another place in its pixel
};

/// How far records are trusted.
struct RecordTrust {
    float residual = 1;    ///< multiplies what neighbours disagree by
    float step = 0.5f;     ///< multiplies what light changes by up to the nearest record
    float noise = 1;       ///< multiplies what their gathering may be off by
    float recalled = 1;    ///< multiplies what light of the last frame may be off by: error scale may be another now
    float strictness = 1;  ///< multiplies the first two, by what a film shows (record_watch.h)
};

/// What multiplies what records disagree by: more where the tolerance is a small share of the luminance that they send
/// into the pixel.
float record_doubt(const PointTolerance& t, float light, float tolerance);

/// What records around a point say of it.
struct RecordEstimate {
    bool holds = false;  ///< within the point's tolerance, as far as they tell
    PointLight light;    ///< of the light trees' trees
    int radius = 0;      ///< pixels that were looked at to each side
    /// The record whose light that is, at its own place in the point's pixel; none where it is light at the point.
    std::optional<std::uint32_t> elsewhere;
};

/// Light of a point by a weighted plane through its neighbours' records, the nearest that agree: radii of 1, 2, 4 and
/// 6 pixels in turn; where none do, that of the nearest record in its own pixel, at the place of that
/// (docs/model/irradiance-cache.md). Notes the use of records where it holds.
RecordEstimate estimate(const RecordQuery& query, const RecordMap& map, Records& records, const RecordTrust& trust,
                        std::int64_t frame);

}  // namespace render2mpeg::renderer
