#include "renderer/cache/receiver.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Records are gathered for a receiver that is at least so bright, so that a black spot of a texture does not leave a
/// record that serves nobody. chosen: 0.05, darker than any paint; not tuned.
constexpr float least_albedo = 0.05f;

}  // namespace

bool uses_cache(const GatherPoint& p) {
    const Bsdf& bsdf = p.point.bsdf;
    return !bsdf.has_glossy() || !bsdf.is_stretched();
}

float receives(const GatherPoint& p) {
    const Bsdf& bsdf = p.point.bsdf;
    const float cosine = glm::dot(p.point.shading_normal, p.point.outgoing);
    const float glossy = bsdf.has_glossy() ? core::luminance(glossy_albedo(bsdf, cosine)) : 0.0f;
    return core::luminance(p.weight) * (std::max(core::luminance(bsdf.diffuse), least_albedo) + glossy);
}

GatherPoint plain_receiver(const GatherPoint& p) {
    GatherPoint receiver = p;
    glm::vec3& albedo = receiver.point.bsdf.diffuse;
    albedo = glm::max(glm::vec3(std::max(core::luminance(albedo), least_albedo)), albedo);
    receiver.weight = glm::vec3(core::luminance(p.weight));
    return receiver;
}

bool take_rays(const RayLight& rays, const GatherPoint& plain, IrradianceRecord& record) {
    for (const glm::vec3& part : rays.light)
        if (!core::is_finite(part)) return false;
    const float share = core::divide_or(1.0f * rays.rays, 1.0f * (record.ray_count + rays.rays), 0.0f);
    for (std::size_t k = 0; k < rays.light.size(); ++k)
        record.by_rays[k] = glm::mix(record.by_rays[k], rays.light[k], share);
    const float own = core::divide_or(rays.batch_variance, receives(plain) * receives(plain), 0.0f);
    record.batch_variance = glm::mix(record.batch_variance, own, share);
    record.ray_count += rays.rays;
    record.next_ray += rays.rays;
    record.baseline.reset();
    return true;
}

RecordPilot pilot_of(const RayLight& rays, const GatherPoint& plain) {
    RecordPilot pilot{rays.light, core::divide_or(rays.difference, receives(plain), 0.0f)};
    for (glm::vec3& part : pilot.light)
        if (!core::is_finite(part)) pilot = {};
    return pilot;
}

RecordBaseline baseline_of(const IrradianceRecord& r) {
    return {r.by_rays, r.pilot, r.batch_variance * batch_share(r.ray_count), r.ray_count};
}

std::optional<IrradianceRecord> record_of(const GatherPoint& p, const PointLight& light, const GlossyRecord& lobe,
                                          const RayLight& rays, float error_scale, std::int64_t frame) {
    IrradianceRecord record;
    record.address = p.point.address;
    record.back_side = p.point.back_side;
    record.path = p.path;
    record.capped = light.capped;
    record.position = p.point.position;
    record.geometric_normal = p.point.geometric_normal;
    record.shading_normal = p.point.shading_normal;
    record.direct = light.direct;
    record.indirect = light.indirect;
    record.lobe = lobe;
    record.error = {core::divide_or(light.error.value, receives(p) * error_scale, 0.0f)};
    record.clamped = core::divide_or(light.clamped, core::luminance(light.scattered(p)), 0.0f);
    record.born = record.used = frame;
    const GatherPoint plain = plain_receiver(p);
    record.pilot = pilot_of(rays, plain);
    const bool finite = take_rays(rays, plain, record) && core::is_finite(record.direct) &&
                        core::is_finite(record.indirect) && core::is_finite(lobe.f0) && core::is_finite(lobe.schlick);
    return finite ? std::optional(record) : std::nullopt;
}

}  // namespace render2mpeg::renderer
