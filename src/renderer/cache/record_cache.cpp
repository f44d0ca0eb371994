#include "renderer/cache/record_cache.h"

#include "core/error.h"
#include "core/numeric.h"
#include "renderer/cache/frame_lighting.h"

namespace render2mpeg::renderer {

void RecordCache::cut_to(const Seen& seen, const scene::Snapshot& snapshot) {
    // Their errors are of another error scale.
    last_ = {};
    trials_.forget();
    watch_.forget();
    RecordMap map(seen.visible.width(), seen.visible.height());
    map.build(records_.all(), snapshot.camera);
    records_.thin(snapshot.frame, map);
}

FrameLight RecordCache::light(const LightTrees& light_trees, const RayTracer& tracer, const Seen& seen,
                              const scene::Snapshot& snapshot, const core::ToleranceMap& tolerance,
                              const CutLimits& limits, ShadeCounts& shade_counts, RecordCounts& counts,
                              const LightParts* parts) {
    EXPECTS(!tolerance.is_reference());
    if (snapshot.cut_before) cut_to(seen, snapshot);
    trust_.strictness = watch_.strictness();
    trust_.recalled = core::divide_or(limits.error_scale, last_error_scale_, 1.0f);
    last_error_scale_ = limits.error_scale;
    FrameLighting frame(light_trees, tracer, seen, snapshot, limits, trust_, trials_, records_, parts);
    frame.prepare(tolerance, last_, last_moved_points_, last_frame_, moved_, shade_counts);
    last_frame_ = snapshot.frame;
    moved_ = false;
    frame.refine(watch_, shade_counts, counts);
    if (parts != nullptr) frame.add_movers(shade_counts, counts);
    frame.thin();
    frame.tell(trials_);
    trials_.judge();
    counts.live = records_.size();
    return frame.take(last_, last_moved_points_, shade_counts, counts);
}

}  // namespace render2mpeg::renderer
