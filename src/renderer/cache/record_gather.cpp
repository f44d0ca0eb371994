#include "renderer/cache/record_gather.h"

#include <algorithm>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Records are gathered for a receiver that is at least so bright, so that a black spot of a texture does not leave a
/// record that serves nobody. chosen: 0.05, darker than any paint; not tuned.
constexpr float least_albedo = 0.05f;

/// Narrower lobes change too fast from place to place and as the eye moves. chosen: 0.04, a roughness of 0.2, of 0.01,
/// 0.04 and 0.25 (docs/fits/records.md).
constexpr float least_alpha = 0.04f;

void gather_group(const Seen& seen, const std::vector<std::vector<PointTolerance>>& tolerances, const CutLimits& limits,
                  const LobeTrials& trials, const RequestGroup& group, Gatherer& gatherer, GatheredRequests& out) {
    GatherPoint receivers[lane_count];
    const GatherPoint* pointers[lane_count];
    GroupTolerance tolerance;
    for (std::size_t i = 0; i < lane_count; ++i) {
        const PointRef& ref = group.points[std::min(i, group.points.size() - 1)];
        tolerance.set(static_cast<int>(i), tolerances[ref.tile][ref.index]);
        if (i >= group.points.size()) continue;
        pointers[i] = &seen.tiles[ref.tile][ref.index];
        if (!takes_records(*pointers[i], trials)) continue;
        receivers[i] = plain_receiver(*pointers[i]);
        pointers[i] = &receivers[i];
    }
    GatherLanes lanes;
    fill(lanes, std::span<const GatherPoint* const>(pointers, group.points.size()));
    lanes.set = group.set;
    GatheredLight gathered;
    gatherer.gather(lanes, tolerance, limits, gathered);
    out.counts.add(gathered, group.points.size());
    for (std::size_t i = 0; i < group.points.size(); ++i) {
        out.points.push_back(group.points[i]);
        const auto lane = static_cast<int>(i);
        PointLight light = point_light(gathered, lane, *pointers[i]);
        // The clamp took from the receiver what it is to have taken from the point, by share.
        const GatherPoint& own = seen.tiles[group.points[i].tile][group.points[i].index];
        light.clamped *= core::divide_or(core::luminance(light.scattered(own)),
                                         core::luminance(light.scattered(*pointers[i])), 0.0f);
        out.light.push_back(light);
        out.sets.push_back(static_cast<std::uint8_t>(group.set));
        out.lobes.emplace_back();
        const SurfacePoint& p = pointers[i]->point;
        if (p.bsdf.has_glossy())
            out.lobes.back() = {p.bsdf.alpha, p.outgoing, gathered.f0.at(lane), gathered.schlick.at(lane)};
    }
}

}  // namespace

bool takes_records(const GatherPoint& p, const LobeTrials& trials) {
    const Bsdf& bsdf = p.point.bsdf;
    return !p.reached_by_specular &&
           (!bsdf.has_glossy() || (bsdf.alpha >= least_alpha && trials.takes(p.point.material)));
}

float receives(const GatherPoint& p) {
    const Bsdf& bsdf = p.point.bsdf;
    const float glossy = bsdf.has_glossy() ? core::luminance(glossy_albedo(bsdf)) : 0.0f;
    return core::luminance(p.weight) * (std::max(core::luminance(bsdf.diffuse), least_albedo) + glossy);
}

GatherPoint plain_receiver(const GatherPoint& p) {
    GatherPoint receiver = p;
    glm::vec3& albedo = receiver.point.bsdf.diffuse;
    albedo = glm::max(glm::vec3(std::max(core::luminance(albedo), least_albedo)), albedo);
    receiver.weight = glm::vec3(core::luminance(p.weight));
    return receiver;
}

std::optional<Record> record_of(const GatherPoint& p, const PointLight& light, const RecordLobe& lobe,
                                float error_scale, std::int64_t frame) {
    Record record;
    record.address = p.point.address;
    record.back_side = p.point.back_side;
    record.capped = light.capped;
    record.position = p.point.position;
    record.geometric_normal = p.point.geometric_normal;
    record.shading_normal = p.point.shading_normal;
    record.direct = light.direct;
    record.indirect = light.indirect;
    record.lobe = lobe;
    record.error = core::divide_or(light.error, receives(p) * error_scale, 0.0f);
    record.clamped = core::divide_or(light.clamped, core::luminance(light.scattered(p)), 0.0f);
    record.born = record.used = frame;
    const bool finite = core::is_finite(record.direct) && core::is_finite(record.indirect) &&
                        core::is_finite(lobe.f0) && core::is_finite(lobe.schlick);
    return finite ? std::optional(record) : std::nullopt;
}

void gather_requests(const LightTrees& light_trees, const RayTracer& tracer, const Seen& seen, glm::vec3 eye,
                     const std::vector<std::vector<PointTolerance>>& tolerances, const CutLimits& limits,
                     const LobeTrials& trials, const std::vector<PointRef>& requests, GatheredRequests& out) {
    Gatherer gatherer(light_trees, tracer);
    for (const RequestGroup& group : group_requests(seen, requests, eye))
        gather_group(seen, tolerances, limits, trials, group, gatherer, out);
}

}  // namespace render2mpeg::renderer
