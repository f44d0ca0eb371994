#pragma once
// Reuses the nearest record within a pixel.
#include "renderer/cache/cache_query.h"

namespace render2mpeg::renderer {

/// Light of the nearest record in the pixel where the point lies: of the point itself, if it lies close and light
/// hardly changes up to it; else, where the point may be moved, of the record's place, if the point and it might be
/// samples of the pixel that share a gather point, and light changes up to it by no more than some tolerances
/// (docs/model/irradiance-cache.md). Nothing where there is none; else notes its use.
void reuse_nearest(const CacheQuery& query, const RecordGrid& grid, RecordStore& records, const CacheErrorModel& model,
                   std::int64_t frame, CacheEstimate& result);

}  // namespace render2mpeg::renderer
