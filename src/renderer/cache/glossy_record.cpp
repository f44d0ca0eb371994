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
/// looks by there. chosen: 1 of 0.125 and 1; how far a surface bends a plane's residual tells
/// (docs/measurements.md#irradiance-cache).
constexpr float most_turn = 1.0f;

/// Square of the change of half vectors as an eye sees a record now, over that of its lobe's width.
float turned2(const IrradianceRecord& r, glm::vec3 eye) {
    const glm::vec3 turn = 0.5f * (r.lobe.outgoing - eye) / r.lobe.alpha;
    return glm::dot(turn, turn);
}

}  // namespace

std::optional<SeenLobe> lobe_at(const CacheQuery& q, const IrradianceRecord& r) {
    const SurfacePoint& p = q.point.point;
    if (!p.bsdf.has_glossy()) return r.lobe.alpha == 0.0f ? std::optional(SeenLobe{}) : std::nullopt;
    const float alpha = p.bsdf.alpha;
    if (!(std::abs(r.lobe.alpha - alpha) <= alike_alpha * alpha)) return std::nullopt;
    const glm::vec3 eye = r.is_of_frame() ? r.lobe.outgoing
                          : q.eye         ? core::normalize_or(*q.eye - r.position, p.outgoing)
                                          : p.outgoing;
    if (turned2(r, eye) > most_turn * most_turn) return std::nullopt;
    const glm::vec3 turn = 0.5f * (r.lobe.outgoing - p.outgoing) - (r.shading_normal - p.shading_normal);
    GlossyRecord lobe = r.lobe;
    lobe.f0 += r.by_rays[1];
    lobe.schlick += r.by_rays[2];
    const glm::vec3 radiance = seen_from(lobe, r.shading_normal, eye, p.bsdf);
    return SeenLobe{radiance, core::luminance(q.point.weight * radiance) / alpha * turn};
}

bool is_lobe_seen_from(const IrradianceRecord& r, glm::vec3 eye) {
    return r.lobe.alpha == 0.0f ||
           turned2(r, core::normalize_or(eye - r.position, r.lobe.outgoing)) <= most_turn * most_turn;
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
