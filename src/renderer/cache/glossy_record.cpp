#include "renderer/cache/glossy_record.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Widths of lobes that count as one.
constexpr float alike_alpha = 0.1f;
/// Half vectors that a record's lobe was looked at by may lie so far, in widths of the lobe, off those that this eye
/// looks by where it sees the same. chosen: 1 of 0.125 and 1 (docs/measurements.md#irradiance-cache).
constexpr float most_turn = 1.0f;

/// Direction in which a record's light goes to an eye that sees what the record shows.
glm::vec3 towards(const IrradianceRecord& r, glm::vec3 eye) {
    return core::normalize_or(eye - r.position + r.lobe.depth * r.lobe.outgoing, r.lobe.outgoing);
}

/// Change of half vectors from the direction that a record was seen by to another, in widths of its lobe.
glm::vec3 turn_of(const IrradianceRecord& r, glm::vec3 outgoing) {
    return 0.5f / r.lobe.alpha * (r.lobe.outgoing - outgoing);
}

bool is_far(glm::vec3 turn) {
    return glm::dot(turn, turn) > most_turn * most_turn;
}

}  // namespace

std::optional<SeenLobe> lobe_at(const CacheQuery& q, const IrradianceRecord& r) {
    const SurfacePoint& p = q.point.point;
    if (!p.bsdf.has_glossy()) return r.lobe.alpha == 0.0f ? std::optional(SeenLobe{}) : std::nullopt;
    const float alpha = p.bsdf.alpha;
    if (!(std::abs(r.lobe.alpha - alpha) <= alike_alpha * alpha)) return std::nullopt;
    const glm::vec3 outgoing = r.is_of_frame() ? r.lobe.outgoing : q.eye ? towards(r, *q.eye) : p.outgoing;
    const glm::vec3 turn = turn_of(r, outgoing);
    if (is_far(turn)) return std::nullopt;
    GlossyRecord lobe = r.lobe;
    lobe.f0 += r.by_rays[1];
    lobe.schlick += r.by_rays[2];
    const glm::vec3 radiance = seen_from(lobe, r.shading_normal, outgoing, p.bsdf);
    const float glossy = core::luminance(q.point.weight * radiance),
                matt = core::luminance(q.point.weight * p.bsdf.diffuse * r.irradiance());
    // A record follows what it shows by the lobe's share of its light.
    const float left_behind = lobe.depth > 0.0f ? core::divide_or(matt, glossy + matt, 0.0f) : 1.0f;
    return SeenLobe{radiance, left_behind * glossy * turn};
}

bool is_lobe_seen_from(const IrradianceRecord& r, glm::vec3 eye) {
    return r.lobe.alpha == 0.0f || !is_far(turn_of(r, towards(r, eye)));
}

/// A typical cosine of light stands for it in [Heitz2014, eq. 99].
glm::vec3 seen_from(const GlossyRecord& lobe, glm::vec3 normal, glm::vec3 outgoing, const Bsdf& bsdf) {
    constexpr float typical = 0.6f, least = 0.05f;
    const float a2 = bsdf.alpha * bsdf.alpha;
    const float here = std::max(glm::dot(normal, outgoing), least),
                there = std::max(glm::dot(normal, lobe.outgoing), least);
    const float ratio = lobe::masking(typical, here, a2) / lobe::masking(typical, there, a2);
    return ratio * (bsdf.f0 * lobe.f0 + bsdf.f90 * lobe.schlick);
}

}  // namespace render2mpeg::renderer
