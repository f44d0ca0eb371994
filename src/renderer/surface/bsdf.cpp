#include "renderer/surface/bsdf.h"

#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {

float DiffuseShape::value(float nl, float nv, float lv) const {
    return lobe::shaped(retro, loss, flat, rough, nl, nv, lv);
}

/// In closed form: the integrals of 2 x^(k + 1) (1 - x)^5 are Beta functions. For `rough` [Portsmouth2025].
float DiffuseShape::albedo(float nv) const {
    constexpr float m0 = 1.0f / 21, m1 = 1.0f / 84, m2 = 1.0f / 252;
    const float v = std::clamp(nv, 0.0f, 1.0f), fv = lobe::schlick(v), a = retro - loss;
    const float square =
        a * a * m0 + 2 * a * retro * v * m1 + retro * retro * (v * v * m2 + 0.5f * (1 - v * v) * (m0 - m2));
    const float disney = 1 + a * m0 + retro * v * m1 + fv * (a + retro * v * (2.0f / 3) + square);
    if (rough == 0) return flat * disney;
    const float sine = core::sqrt_or_zero(1 - v * v), third = 2.0f / 3;
    const float low = v < 1e-3f ? v : third * sine / v * (1 - sine * sine * sine);
    const float g = sine * (std::acos(v) - third - sine * v) + low;
    return flat * disney + rough * lobe::inverse_pi * g;
}

DiffuseShape DiffuseShape::oren_nayar(float roughness) {
    constexpr float pi = std::numbers::pi_v<float>;
    const float flat = 1 / (1 + roughness * (0.5f - 2 / (3 * pi)));
    return {0, 0, flat, roughness * flat};
}

glm::vec3 diffuse_weight(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light) {
    if (!bsdf.has_glossy()) return bsdf.diffuse;
    const float lv = glm::dot(outgoing, to_light);
    float share = 1.0f;
    if (bsdf.has_lobe()) share -= bsdf.covered * lobe::schlick(core::sqrt_or_zero(0.5f * (1.0f + lv)));
    if (!bsdf.shape.is_lambert()) share *= bsdf.shape.value(glm::dot(normal, to_light), glm::dot(normal, outgoing), lv);
    return bsdf.diffuse * share;
}

float diffuse_share(const Bsdf& bsdf, float cosine) {
    float share = 1.0f;
    if (bsdf.has_lobe()) share -= bsdf.covered * mean_schlick(cosine);
    return bsdf.shape.is_lambert() ? share : share * bsdf.shape.albedo(cosine);
}

glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light) {
    const float nl = glm::dot(normal, to_light);
    const float nv = glm::dot(normal, outgoing);
    if (!(nl > 0.0f) || !(nv > 0.0f)) return glm::vec3(0);
    glm::vec3 f = diffuse_weight(bsdf, normal, outgoing, to_light) * lobe::inverse_pi;
    if (bsdf.has_lobe()) {
        const glm::vec3 h = core::normalize_or(to_light + outgoing, normal);
        if (bsdf.is_stretched()) {
            const StretchedLobe stretched(bsdf, normal);
            const float s = lobe::schlick(glm::dot(outgoing, h));
            return f + stretched.distribution(stretched.local(h)) *
                           stretched.masking(stretched.local(to_light), stretched.local(outgoing)) *
                           (bsdf.f0 * (1.0f - s) + bsdf.f90 * s);
        }
        const float nh = glm::dot(normal, h);
        const float a2 = bsdf.alpha * bsdf.alpha;
        const float s = lobe::schlick(glm::dot(outgoing, h));
        f += lobe::distribution(std::min(nh * nh, 1.0f), a2) * lobe::masking(nl, nv, a2) *
             (bsdf.f0 * (1.0f - s) + bsdf.f90 * s);
    }
    return f;
}

glm::vec3 diffuse_albedo(const Bsdf& bsdf, float cosine) {
    return bsdf.has_glossy() ? bsdf.diffuse * diffuse_share(bsdf, cosine) : bsdf.diffuse;
}

glm::vec3 glossy_albedo(const Bsdf& bsdf, float cosine) {
    if (!bsdf.has_lobe()) return glm::vec3(0);
    const LobeAlbedo albedo = lobe_albedo(cosine, bsdf.mean_alpha());
    return albedo.f0 * bsdf.f0 + albedo.f90 * bsdf.f90;
}

namespace {

LobeSample sample_stretched(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u) {
    const StretchedLobe stretched(bsdf, normal);
    const glm::vec3 v = stretched.local(outgoing);
    if (!(v.z > 0.0f)) return {normal, glm::vec3(0)};
    const glm::vec3 h = visible_normal(v, stretched.alpha, u);
    const float vh = std::max(glm::dot(v, h), 0.0f);
    const glm::vec3 l = 2.0f * vh * h - v;
    LobeSample sample;
    sample.direction = core::normalize_or(stretched.world(l), normal);
    const float density = stretched.density(h, v);
    if (!(l.z > 0.0f) || !(density > 0.0f)) return sample;
    const float s = lobe::schlick(vh);
    sample.weight =
        (stretched.distribution(h) * stretched.masking(l, v) * l.z / density) * (bsdf.f0 * (1.0f - s) + bsdf.f90 * s);
    return sample;
}

}  // namespace

StretchedLobe::StretchedLobe(const Bsdf& bsdf, glm::vec3 normal) : z(normal), alpha(bsdf.alpha_along, bsdf.alpha) {
    glm::vec3 t, b;
    core::make_frame(normal, t, b);
    x = core::normalize_or(bsdf.along - glm::dot(bsdf.along, normal) * normal, t);
    y = glm::cross(normal, x);
}

float StretchedLobe::distribution(glm::vec3 half) const {
    const glm::vec3 h(half.x / alpha.x, half.y / alpha.y, half.z);
    const float e = std::max(glm::dot(h, h), 1e-12f);
    return lobe::inverse_pi / (alpha.x * alpha.y * e * e);
}

float StretchedLobe::length(glm::vec3 v) const {
    return glm::length(glm::vec3(alpha.x * v.x, alpha.y * v.y, v.z));
}

float StretchedLobe::masking(glm::vec3 light, glm::vec3 view) const {
    return 0.5f / std::max(view.z * length(light) + light.z * length(view), 1e-12f);
}

float StretchedLobe::density(glm::vec3 half, glm::vec3 view) const {
    return 0.5f * distribution(half) / std::max(view.z + length(view), 1e-12f);
}

LobeSample sample_glossy(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u) {
    if (bsdf.is_stretched()) return sample_stretched(bsdf, normal, outgoing, u);
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
    return visible_normal(outgoing, glm::vec2(alpha), u);
}

glm::vec3 visible_normal(glm::vec3 outgoing, glm::vec2 alpha, glm::vec2 u) {
    const glm::vec3 v = glm::normalize(glm::vec3(alpha.x * outgoing.x, alpha.y * outgoing.y, outgoing.z));
    const float across2 = v.x * v.x + v.y * v.y;
    const glm::vec3 t1 = across2 > 0.0f ? glm::vec3(-v.y, v.x, 0) / std::sqrt(across2) : glm::vec3(1, 0, 0);
    const glm::vec3 t2 = glm::cross(v, t1);
    const float r = std::sqrt(u.x), phi = 2.0f * std::numbers::pi_v<float> * u.y;
    const float a = r * std::cos(phi), s = 0.5f * (1.0f + v.z);
    const float b = std::lerp(core::sqrt_or_zero(1.0f - a * a), r * std::sin(phi), s);
    const glm::vec3 n = a * t1 + b * t2 + core::sqrt_or_zero(1.0f - a * a - b * b) * v;
    return glm::normalize(glm::vec3(alpha.x * n.x, alpha.y * n.y, std::max(n.z, 1e-6f)));
}

}  // namespace render2mpeg::renderer
