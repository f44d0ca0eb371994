#include "renderer/cache/irradiance_cache.h"

#include "core/error.h"
#include "core/numeric.h"
#include "renderer/cache/cache_lookup.h"

namespace render2mpeg::renderer {
void IrradianceCache::forget() {
    records_.forget();
    validation_.forget();
    history_ = {};
}

void IrradianceCache::invalidate() {
    records_.forget();
    history_.tiles.clear();
}

void IrradianceCache::cut_to(const Seen& seen, const scene::Snapshot& snapshot) {
    // The last frame's errors are of another error scale.
    history_.tiles.clear();
    validation_.forget();
    RecordGrid grid(seen.visible.width(), seen.visible.height());
    grid.build(records_.all(), snapshot.camera);
    records_.thin(snapshot.frame, grid);
}

FrameLight IrradianceCache::light(const LightingContext& context, const scene::Snapshot& snapshot,
                                  const CutLimits& limits, FinalGather* rays, ShadeCounts& shade_counts,
                                  CacheCounts& counts) {
    EXPECTS(!context.tolerance.is_reference());
    if (snapshot.cut_before) cut_to(context.seen, snapshot);
    errors_.cache_error_scale = validation_.cache_error_scale();
    errors_.reused = core::divide_or(limits.error_scale, last_error_scale_, 1.0f);
    last_error_scale_ = limits.error_scale;

    // Reuse the last frame's light,
    FrameState frame(context, snapshot, limits, errors_, records_, rays);
    start(frame, context.tolerance, history_);
    // ask the cache for the rest, or gather it,
    light_points(frame, validation_);
    // and remember.
    records_.thin(snapshot.frame, frame.grid);
    FrameLight light = finish(frame, history_);
    frame.counts.live = frame.counts.most = records_.size();
    counts.add(frame.counts);
    shade_counts.add(frame.shade_counts);
    return light;
}

MovedPoints IrradianceCache::moved_points(std::int64_t frame, const core::ToleranceMap& tolerance) const {
    return frame != history_.frame || tolerance.is_reference() ? MovedPoints{} : history_.moved_points;
}

core::Plane<float> IrradianceCache::density(const scene::Camera& camera, const scene::PictureFormat& format) const {
    RecordGrid grid(format.width, format.height);
    grid.build(records_.all(), camera);
    return grid.density();
}

}  // namespace render2mpeg::renderer
