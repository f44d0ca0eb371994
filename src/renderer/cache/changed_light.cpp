#include "renderer/cache/changed_light.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/cache/gather_requests.h"
#include "renderer/cache/local_regression.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Records of one task.
constexpr std::size_t records_of_task = 64;

/// Calls body(i) for records, from many threads.
template <class Body>
void for_each_of(std::size_t count, const Body& body) {
    parallel::for_ranges(count, records_of_task, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) body(i);
    });
}

/// Extent of a pixel at a place of the picture, world.
float extent_at(const scene::Camera& camera, glm::vec3 place) {
    const auto seen = camera.project(place);
    return camera.pixel_extent(seen ? seen->depth : 1.0f);
}

/// Poses a record as its surface lies now, and the receiver in its place. False: it is gone, or another.
bool pose(const PosedScene& scene, const scene::Camera& camera, IrradianceRecord& r, GatherPoint& receiver) {
    if (!scene.posed().objects[r.address.object].present) return false;
    const bool glossy = r.lobe.alpha > 0.0f;
    glm::vec3 along, across;
    core::make_frame(r.geometric_normal, along, across);
    const float extent = extent_at(camera, r.position);
    SurfacePoint& p = receiver.point;
    p = scene.surface_at(r.address, glossy ? r.lobe.outgoing : r.geometric_normal, {extent * along, extent * across});
    if (p.back_side != r.back_side || p.bsdf.has_glossy() != glossy || !core::is_finite(p.position)) return false;
    if (p.position == r.position && p.geometric_normal == r.geometric_normal) {
        p.shading_normal = r.shading_normal;
    } else {
        r.position = p.position;
        r.geometric_normal = p.geometric_normal;
        r.shading_normal = p.shading_normal;
    }
    if (camera.has_eye() && !is_lobe_seen_from(r, camera.eye_of(r.position))) return false;
    if (glossy) p.bsdf.alpha = r.lobe.alpha;
    receiver = plain_receiver(receiver);
    return true;
}

/// Drops all records but those that are marked.
void keep_only(FrameState& frame, std::vector<GatherPoint>& receivers, std::span<const std::uint8_t> keeps) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (keeps[i] != 0 && kept++ != i) receivers[kept - 1] = std::move(receivers[i]);
    receivers.resize(kept);
    std::size_t i = 0;
    frame.records.drop([&](const IrradianceRecord&) { return keeps[i++] == 0; });
    frame.grid.build(frame.records.all(), frame.camera());
}

/// Drops all records but the one of the most rays of each surface in each pixel of the picture and its border.
void thin(FrameState& frame, std::vector<GatherPoint>& receivers, std::span<const std::uint8_t> holds) {
    frame.grid.build(frame.records.all(), frame.camera());
    std::vector<std::uint8_t> keeps(frame.records.size(), 0);
    const std::span<const SurfaceMark> marks = frame.grid.marks();
    for_each_pixel(marks, [&](std::span<const SurfaceMark> all) {
        std::vector<SurfaceMark> here;
        for (const SurfaceMark& m : all)
            if (holds[m.record] != 0) here.push_back(m);
        std::stable_sort(here.begin(), here.end(), [&](const SurfaceMark& a, const SurfaceMark& b) {
            const auto rays = [&](const SurfaceMark& m) { return frame.records[m.record].ray_count; };
            return a.surface != b.surface ? a.surface < b.surface : rays(a) > rays(b);
        });
        for (const SurfaceMark& m : here)
            keeps[m.record] = std::none_of(here.begin(), here.end(), [&](const SurfaceMark& other) {
                return keeps[other.record] != 0 && other.surface == m.surface &&
                       glm::dot(other.shading_normal, m.shading_normal) >= same_normal;
            });
    });
    keep_only(frame, receivers, keeps);
}

/// A record's light now, by its own before and its neighbours' pilots.
struct RecordUpdate {
    std::array<glm::vec3, 3> light{};
    float batch_variance = 0;  ///< as IrradianceRecord's
    std::uint32_t rays = 0;
    bool is_pilot = true;     ///< that of its pilot alone
    bool needs_pilot = true;  ///< retracing its pilot takes fewer rays than it would lose
    bool is_lost = false;     ///< neither its neighbours' pilots nor one of its own tell its light
};

RecordUpdate updated(const FrameState& frame, const SurfaceMark& mark, const GatherPoint& receiver,
                     LocalRegression& fit) {
    const IrradianceRecord& r = frame.records[mark.record];
    const float shown = receives(receiver), shown2 = shown * shown;
    RecordUpdate now{r.pilot.light, 0.5f * r.pilot.difference * r.pilot.difference, pilot_rays};
    now.is_lost = !r.is_pilot_now;
    now.needs_pilot = now.is_lost && r.baseline->ray_count > pilot_rays;
    const auto eye = frame.camera().has_eye() ? std::optional(frame.camera().eye_of(r.position)) : std::nullopt;
    CacheQuery query{receiver, {}, mark.at, extent_at(frame.camera(), r.position), shown, eye};
    query.priced = frame.allocation.typical > 0.0f;
    fit.collect(query, LocalRegression::Of::change, frame.grid, frame.records, mark.record);
    const RegressionError error = fit.estimate();
    if (!error.is_valid()) return now;
    now.batch_variance = fit.batch_variance_now() / shown2;
    const RecordBaseline& before = *r.baseline;
    const double factor = fit.factor(), variance = factor * factor * before.variance + error.square / shown2,
                 of_pilot = now.batch_variance * batch_share(pilot_rays);
    if (!(variance < of_pilot)) return now;
    now.is_pilot = now.is_lost = false;
    std::array<glm::dvec3, 3> light{};
    for (std::size_t k = 0; k < light.size(); ++k) light[k] = factor * glm::dvec3(before.light[k]);
    for (std::size_t i = 0; i < fit.size(); ++i) {
        if (fit.weight(i) == 0.0f) continue;
        const IrradianceRecord& other = frame.records[fit.record(i)];
        for (std::size_t k = 0; k < light.size(); ++k)
            light[k] += static_cast<double>(fit.weight(i)) *
                        (glm::dvec3(other.pilot.light[k]) - factor * glm::dvec3(other.baseline->pilot.light[k]));
    }
    for (std::size_t k = 0; k < light.size(); ++k) now.light[k] = glm::max(glm::vec3(light[k]), glm::vec3(0));
    now.rays =
        static_cast<std::uint32_t>(std::clamp(samples_for(variance, batch_rays, now.batch_variance, variance_power),
                                              1.0 * pilot_rays, 1.0 * std::max(before.ray_count, pilot_rays)));
    now.needs_pilot = before.ray_count > now.rays + pilot_rays;
    return now;
}

}  // namespace

void retrace_pilots(FrameState& frame, std::span<const std::uint32_t> which,
                    std::span<const GatherPoint* const> receivers) {
    std::vector<GatherRequest> requests(which.size());
    for_each_of(which.size(), [&](std::size_t k) {
        requests[k] = request_of(*receivers[k], {}, {0, 0}, frame.camera());
        requests[k].numbers = frame.records[which[k]].numbers;
        requests[k].rays = pilot_rays;
    });
    const std::vector<RayLight> found = frame.rays->gather(requests, frame.allocation);
    for_each_of(which.size(), [&](std::size_t k) {
        IrradianceRecord& r = frame.records.change(which[k]);
        r.pilot = pilot_of(found[k], *receivers[k]);
        r.is_pilot_now = true;
    });
}

void update_by_control_variates(FrameState& frame) {
    const PosedScene& scene = frame.rays->posed_scene();
    std::vector<GatherPoint> receivers(frame.records.size());
    std::vector<std::uint8_t> holds(frame.records.size());
    const auto record = [&](std::size_t i) -> IrradianceRecord& {
        return frame.records.change(static_cast<std::uint32_t>(i));
    };
    for_each_of(receivers.size(),
                [&](std::size_t i) { holds[i] = pose(scene, frame.camera(), record(i), receivers[i]) ? 1 : 0; });
    thin(frame, receivers, holds);
    for_each_of(frame.records.size(), [&](std::size_t i) {
        IrradianceRecord& r = record(i);
        if (!r.baseline) r.baseline = std::make_shared<const RecordBaseline>(baseline_of(r));
    });
    // Retrace the pilots of every second pixel of every second row, then where this tells too little.
    std::vector<SurfaceMark> marks(frame.grid.marks().begin(), frame.grid.marks().end());
    std::vector<RecordUpdate> now(frame.records.size());
    std::vector<std::uint32_t> retraced;
    for (const SurfaceMark& m : marks) {
        frame.records.change(m.record).is_pilot_now = false;
        const glm::ivec2 pixel(glm::floor(m.at));
        if (pixel.x % 2 == 0 && pixel.y % 2 == 0) retraced.push_back(m.record);
    }
    do {
        std::vector<const GatherPoint*> pointers;
        for (const std::uint32_t i : retraced) pointers.push_back(&receivers[i]);
        retrace_pilots(frame, retraced, pointers);
        retraced.clear();
        parallel::for_ranges(marks.size(), records_of_task, [&](std::size_t first, std::size_t last) {
            LocalRegression fit;
            for (std::size_t i = first; i < last; ++i)
                now[marks[i].record] = updated(frame, marks[i], receivers[marks[i].record], fit);
        });
        std::erase_if(marks, [&](const SurfaceMark& m) { return !now[m.record].needs_pilot; });
        for (const SurfaceMark& m : marks)
            if (!frame.records[m.record].is_pilot_now) retraced.push_back(m.record);
    } while (!retraced.empty());
    for_each_of(now.size(), [&](std::size_t i) {
        IrradianceRecord& r = record(i);
        r.by_rays = now[i].light;
        r.batch_variance = now[i].batch_variance;
        r.ray_count = now[i].rays;
        if (now[i].is_pilot) r.baseline.reset();
        holds[i] = now[i].is_lost ? 0 : 1;
    });
    holds.resize(now.size());
    keep_only(frame, receivers, holds);
    gather_trees_again(frame, receivers);
    frame.records.drop([](const IrradianceRecord& r) {
        return !core::is_finite(r.irradiance() + r.lobe.f0 + r.lobe.schlick + r.by_rays[1] + r.by_rays[2]);
    });
    frame.grid.build(frame.records.all(), frame.camera());
}

}  // namespace render2mpeg::renderer
