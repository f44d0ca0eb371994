#include "renderer/paths/path_directions.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

float mean_channel(glm::vec3 v) {
    return (v.x + v.y + v.z) / 3.0f;
}

}  // namespace

glm::vec3 whole_albedo(const SurfacePoint& p) {
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    return diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine);
}

/// chosen: by what it reflects, a tenth at least, so that no part of f_s is much larger than its density.
float lobe_chance(const SurfacePoint& p) {
    if (!p.bsdf.has_lobe()) return 0.0f;
    if (!p.bsdf.has_diffuse()) return 1.0f;
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    const float diffuse = mean_channel(diffuse_albedo(p.bsdf, cosine)),
                glossy = mean_channel(glossy_albedo(p.bsdf, cosine));
    return std::clamp(core::divide_or(glossy, diffuse + glossy, 0.5f), 0.1f, 0.9f);
}

float direction_density(const SurfacePoint& p, float chance, glm::vec3 direction) {
    const float nl = glm::dot(p.shading_normal, direction), nv = glm::dot(p.shading_normal, p.outgoing);
    if (!(nl > 0.0f) || !(nv > 0.0f)) return 0.0f;
    float density = (1.0f - chance) * nl * lobe::inverse_pi;
    if (chance > 0.0f && p.bsdf.is_stretched()) {
        const StretchedLobe stretched(p.bsdf, p.shading_normal);
        const glm::vec3 h = stretched.local(core::normalize_or(direction + p.outgoing, p.shading_normal));
        density += chance * stretched.density(h, stretched.local(p.outgoing));
    } else if (chance > 0.0f) {
        const float nh = glm::dot(p.shading_normal, core::normalize_or(direction + p.outgoing, p.shading_normal));
        const float a2 = p.bsdf.alpha * p.bsdf.alpha;
        const float seen = 2.0f / (nv + std::sqrt(a2 + (1.0f - a2) * nv * nv));  // [Heitz2018, eq. 17], over 4 nv
        density += chance * 0.25f * seen * lobe::distribution(std::min(nh * nh, 1.0f), a2);
    }
    return density;
}

glm::vec3 chosen_direction(const SurfacePoint& p, bool by_lobe, glm::vec2 u) {
    if (!by_lobe) return core::sample_cosine_hemisphere(p.shading_normal, u);
    if (p.bsdf.is_stretched()) return sample_glossy(p.bsdf, p.shading_normal, p.outgoing, u).direction;
    glm::vec3 t, b;
    core::make_frame(p.shading_normal, t, b);
    const glm::vec3 v(glm::dot(t, p.outgoing), glm::dot(b, p.outgoing), glm::dot(p.shading_normal, p.outgoing));
    const glm::vec3 h = visible_normal(v, p.bsdf.alpha, u);
    const glm::vec3 l = 2.0f * std::max(glm::dot(v, h), 0.0f) * h - v;
    return core::normalize_or(l.x * t + l.y * b + l.z * p.shading_normal, p.shading_normal);
}

}  // namespace render2mpeg::renderer
