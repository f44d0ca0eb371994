#include "renderer/cache/irradiance_cache.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"
#include "renderer/cache/cache_lookup.h"
#include "renderer/cache/changed_light.h"
#include "renderer/cache/gather_requests.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

void IrradianceCache::forget() {
    records_.forget();
    library_.start_chunk();
    left_.clear();
    histories_ = {};
    other_eye_.forget();
}

void IrradianceCache::light_changes() {
    for (FrameHistory& history : histories_) history.tiles.clear();
    is_other_light_ = true;
}

void IrradianceCache::cut_to(const Frame& seen, const scene::Snapshot& snapshot) {
    // The last frame's errors are of another error scale.
    for (FrameHistory& history : histories_) history.tiles.clear();
    RecordGrid grid(seen.visible.width(), seen.visible.height());
    grid.build(records_.all(), snapshot.camera);
    library_.note(records_.thin(snapshot.frame, grid), near_field_, left_);
}

std::uint64_t IrradianceCache::take_known(const Frame& seen, std::int64_t frame) {
    const std::size_t before = records_.size();
    for (const GatherTile& tile : seen.tiles)
        for (const GatherPoint& p : tile)
            if (uses_cache(p) && !p.reached_by_specular())
                if (const auto record = library_.take(p.point, near_field_, frame)) records_.insert(*record);
    return records_.size() - before;
}

void IrradianceCache::forget_records() {
    library_.note(records_.all(), near_field_, left_);
    records_.forget();
}

bool IrradianceCache::is_sound(const scene::Animation& scene) const {
    const auto is_there = [&](const core::SurfaceAddress& a) {
        return a.object < scene.objects.size() &&
               a.primitive < scene.meshes[static_cast<std::size_t>(scene.objects[a.object].mesh)].primitives();
    };
    return std::ranges::all_of(
        records_.all(), [&](const IrradianceRecord& r) { return is_there(r.address) && r.set < representative_sets; });
}

std::vector<StoredRecord> IrradianceCache::found() const {
    std::vector<StoredRecord> found = left_;
    library_.note(records_.all(), near_field_, found);
    return found;
}

FrameLight IrradianceCache::light(const LightingContext& context, const scene::Snapshot& snapshot,
                                  const CutLimits& limits, FinalGather* rays, ShadeCounts& shade_counts,
                                  CacheCounts& counts) {
    EXPECTS(!context.tolerance.is_reference());
    if (snapshot.cut_before) cut_to(context.seen, snapshot);
    FrameHistory& history = histories_[snapshot.camera.eye_number()];
    const float reused_error =
        core::divide_or(limits.error_scale, std::exchange(history.error_scale, limits.error_scale), 1.0f);

    if (snapshot.camera.lens().eye != scene::Eye::right) other_eye_.forget();
    FrameState frame(context, snapshot, limits, rays, records_, other_eye_);
    if (std::exchange(is_other_light_, false)) {
        if (rays != nullptr && !snapshot.cut_before)
            update_by_control_variates(frame);
        else
            forget_records();
    }
    if (rays != nullptr) near_field_ = rays->near_field().key();
    if (!library_.is_empty()) counts.known += take_known(context.seen, snapshot.frame);
    // Reuse the last frame's light,
    start(frame, history, reused_error);
    // ask the cache for the rest, or gather it,
    light_points(frame);
    // and remember.
    library_.note(records_.thin(snapshot.frame, frame.grid), near_field_, left_);
    if (frame.is_of(scene::Eye::left)) tell(frame, other_eye_);
    FrameLight light = finish(frame, history);
    if (frame.is_of(scene::Eye::right)) other_eye_.forget();
    frame.counts.live = frame.counts.most = records_.size();
    counts.add(frame.counts);
    shade_counts.add(frame.shade_counts);
    return light;
}

core::Plane<float> IrradianceCache::density(const scene::Camera& camera, const scene::PictureFormat& format) const {
    RecordGrid grid(format.width, format.height);
    grid.build(records_.all(), camera);
    return grid.density();
}

}  // namespace render2mpeg::renderer
