#include "renderer/cache/irradiance_cache.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "renderer/cache/cache_lookup.h"
#include "renderer/cache/gather_requests.h"

namespace render2mpeg::renderer {
namespace {

/// A record whose light has become so many times brighter has too few rays. chosen: 2; not tuned.
constexpr float most_brighter = 2.0f;

/// Adds what its rays find otherwise to a record.
void take_change(IrradianceRecord& r) {
    KeptRays& rays = *r.rays;
    const auto all = [&] { return core::luminance(r.irradiance() + r.lobe.f0 + r.by_rays[1]); };
    const float before = all();
    r.direct = glm::max(r.direct + rays.tree_change[0], glm::vec3(0));
    r.indirect = glm::max(r.indirect + rays.tree_change[1], glm::vec3(0));
    r.lobe.f0 = glm::max(r.lobe.f0 + rays.tree_change[2], glm::vec3(0));
    r.lobe.schlick = glm::max(r.lobe.schlick + rays.tree_change[3], glm::vec3(0));
    for (std::size_t k = 0; k < r.by_rays.size(); ++k)
        r.by_rays[k] = glm::max(r.by_rays[k] + rays.change[k], glm::vec3(0));
    const float ratio = core::divide_or(all(), before, 1.0f), more = std::max(ratio, 1.0f);
    rays.brighter *= ratio;
    r.error *= more;
    r.batch_variance *= more * more;
    rays.is_lost = rays.is_lost || rays.brighter > most_brighter || !core::is_finite(r.irradiance());
}

}  // namespace

void IrradianceCache::forget() {
    records_.forget();
    history_ = {};
}

void IrradianceCache::invalidate() {
    records_.forget();
    history_.tiles.clear();
}

void IrradianceCache::renew(const LightChange& change, const LightTrees& trees, const RayTracer& tracer,
                            CutLimits limits, const SkyOfRays& sky, FinalGather& rays) {
    history_.tiles.clear();
    records_.drop([&](const IrradianceRecord& r) {
        return !r.rays || change.moves(r.address.object) || change.holds(r.position);
    });
    limits.exact = false;
    std::vector<KeptRays*> kept;
    // Of one pool next to each other.
    std::vector<std::uint32_t> order(records_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return records_[a].rays->pool < records_[b].rays->pool; });
    for (const std::uint32_t i : order) kept.push_back(records_[i].rays.get());
    if (!rays.renew(change, sky, kept)) {
        records_.forget();
        return;
    }
    if (!trees.empty()) gather_trees_again(trees, tracer, limits, kept);
    for (IrradianceRecord& r : records_.all()) take_change(r);
    records_.drop([](const IrradianceRecord& r) { return r.rays->is_lost; });
}

void IrradianceCache::cut_to(const Frame& seen, const scene::Snapshot& snapshot) {
    // The last frame's errors are of another error scale.
    history_.tiles.clear();
    RecordGrid grid(seen.visible.width(), seen.visible.height());
    grid.build(records_.all(), snapshot.camera);
    records_.thin(snapshot.frame, grid);
}

FrameLight IrradianceCache::light(const LightingContext& context, const scene::Snapshot& snapshot,
                                  const CutLimits& limits, FinalGather* rays, ShadeCounts& shade_counts,
                                  CacheCounts& counts) {
    EXPECTS(!context.tolerance.is_reference());
    if (snapshot.cut_before) cut_to(context.seen, snapshot);
    const float reused_error =
        core::divide_or(limits.error_scale, std::exchange(last_error_scale_, limits.error_scale), 1.0f);

    // Reuse the last frame's light,
    FrameState frame(context, snapshot, limits, reused_error, records_, rays);
    start(frame, context, history_);
    // ask the cache for the rest, or gather it,
    light_points(frame);
    // and remember.
    records_.thin(snapshot.frame, frame.grid);
    FrameLight light = finish(frame, history_);
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
