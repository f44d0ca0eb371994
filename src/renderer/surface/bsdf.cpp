#include "renderer/surface/bsdf.h"

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {

glm::vec3 diffuse_weight(const Bsdf& bsdf, glm::vec3 outgoing, glm::vec3 to_light) {
    if (!bsdf.has_glossy()) return bsdf.diffuse;
    const float vh = core::sqrt_or_zero(0.5f * (1.0f + glm::dot(outgoing, to_light)));
    return bsdf.diffuse * (1.0f - lobe::schlick(vh));
}

glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light) {
    const float nl = glm::dot(normal, to_light);
    const float nv = glm::dot(normal, outgoing);
    if (!(nl > 0.0f) || !(nv > 0.0f)) return glm::vec3(0);
    glm::vec3 f = diffuse_weight(bsdf, outgoing, to_light) * lobe::inverse_pi;
    if (bsdf.has_glossy()) {
        const glm::vec3 h = core::normalize_or(to_light + outgoing, normal);
        const float nh = glm::dot(normal, h);
        const float a2 = bsdf.alpha * bsdf.alpha;
        const float s = lobe::schlick(glm::dot(outgoing, h));
        f += lobe::distribution(std::min(nh * nh, 1.0f), a2) * lobe::masking(nl, nv, a2) *
             (bsdf.f0 * (1.0f - s) + bsdf.f90 * s);
    }
    return f;
}

glm::vec3 diffuse_albedo(const Bsdf& bsdf, float cosine) {
    return bsdf.has_glossy() ? bsdf.diffuse * (1.0f - mean_schlick(cosine)) : bsdf.diffuse;
}

glm::vec3 glossy_albedo(const Bsdf& bsdf, float cosine) {
    if (!bsdf.has_glossy()) return glm::vec3(0);
    const LobeAlbedo albedo = lobe_albedo(cosine, bsdf.alpha);
    return albedo.f0 * bsdf.f0 + albedo.f90 * bsdf.f90;
}

LobeSample sample_glossy(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u) {
    // Choose the half vector in proportion to D n.h.
    const float a2 = bsdf.alpha * bsdf.alpha;
    const float cos2 = core::divide_or(1.0f - u.x, 1.0f + (a2 - 1.0f) * u.x, 1.0f);
    const float cosine = core::sqrt_or_zero(cos2), sine = core::sqrt_or_zero(1.0f - cos2);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    glm::vec3 t, b;
    core::make_frame(normal, t, b);
    const glm::vec3 h = sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * normal;
    // Mirror about it: f cos / pdf = F V 4 nl (v.h) / n.h, the distribution cancels.
    const float vh = glm::dot(outgoing, h);
    LobeSample sample;
    sample.direction = core::normalize_or(2.0f * vh * h - outgoing, normal);
    const float nl = glm::dot(normal, sample.direction), nv = glm::dot(normal, outgoing);
    if (!(nl > 0.0f) || !(nv > 0.0f) || !(vh > 0.0f)) return sample;
    const float s = lobe::schlick(vh);
    const float scale = core::divide_or(lobe::masking(nl, nv, a2) * 4.0f * nl * vh, cosine, 0.0f);
    sample.weight = scale * (bsdf.f0 * (1.0f - s) + bsdf.f90 * s);
    return sample;
}

glm::vec3 visible_normal(glm::vec3 outgoing, float alpha, glm::vec2 u) {
    const glm::vec3 v = glm::normalize(glm::vec3(alpha * outgoing.x, alpha * outgoing.y, outgoing.z));
    const float across2 = v.x * v.x + v.y * v.y;
    const glm::vec3 t1 = across2 > 0.0f ? glm::vec3(-v.y, v.x, 0) / std::sqrt(across2) : glm::vec3(1, 0, 0);
    const glm::vec3 t2 = glm::cross(v, t1);
    const float r = std::sqrt(u.x), phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float a = r * std::cos(phi), s = 0.5f * (1.0f + v.z);
    const float b = std::lerp(core::sqrt_or_zero(1.0f - a * a), r * std::sin(phi), s);
    const glm::vec3 n = a * t1 + b * t2 + core::sqrt_or_zero(1.0f - a * a - b * b) * v;
    return glm::normalize(glm::vec3(alpha * n.x, alpha * n.y, std::max(n.z, 1e-6f)));
}

}  // namespace render2mpeg::renderer
