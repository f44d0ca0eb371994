// Scattering of hair fibres [Chiang2016]. Changed: the azimuth is counted from the outgoing direction, and the cosine
// of the rendering equation is in the function, which it cancels there.
#include "renderer/surface/hair_scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

constexpr float pi = std::numbers::pi_v<float>, two_pi = 2.0f * pi;

/// Smoothest lobes: narrower ones than these are no more than noise of rays. chosen: 1e-3 in both roughnesses, as small
/// as single precision holds.
constexpr float least_hair_roughness = 1e-3f;

float sqr(float x) {
    return x * x;
}
float power(float x, int n) {
    float result = 1.0f;
    for (int k = 0; k < n; ++k) result *= x;
    return result;
}

/// The modified Bessel function of order 0 where 0 <= x < `near_bessel`, and times exp(-x) beyond; within 2e-7.
/// [Abramowitz1964, 9.8.1, 9.8.2]
constexpr float near_bessel = 3.75f;
float bessel_near(float x) {
    const float t = x * x / (near_bessel * near_bessel);
    return 1.0f + t * (3.5156229f +
                       t * (3.0899424f + t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
}
float bessel_beyond(float x) {
    constexpr float c[] = {0.00392377f,  -0.01647633f, 0.02635537f, -0.02057706f, 0.00916281f,
                           -0.00157565f, 0.00225319f,  0.01328592f, 0.39894228f};
    float sum = 0.0f;
    for (const float k : c) sum = sum * (near_bessel / x) + k;
    return sum / std::sqrt(x);
}

/// Of light that leaves a dielectric for another one. [Chiang2016, eq. 10]
float fresnel_at(float cosine, float ior) {
    const float sine2 = (1.0f - cosine * cosine) / (ior * ior);
    if (sine2 >= 1.0f) return 1.0f;
    const float beyond = std::sqrt(1.0f - sine2);
    const float parallel = (ior * cosine - beyond) / (ior * cosine + beyond),
                across = (cosine - ior * beyond) / (cosine + ior * beyond);
    return 0.5f * (parallel * parallel + across * across);
}

/// [Chiang2016, eq. 7]
float variance_of(float roughness) {
    const float b = std::clamp(roughness, least_hair_roughness, 1.0f);
    return sqr(0.726f * b + 0.812f * b * b + 3.7f * power(b, 20));
}

/// [Chiang2016, eq. 8]
float scale_of(float roughness) {
    const float b = std::clamp(roughness, least_hair_roughness, 1.0f);
    return std::sqrt(pi / 8.0f) * (0.265f * b + 1.194f * b * b + 5.372f * power(b, 22));
}

float logistic_sum(float x, float scale) {
    return 1.0f / (1.0f + std::exp(-x / scale));
}

float within_half_turns(float angle) {
    return angle - two_pi * std::round(angle / two_pi);
}

}  // namespace

HairScattering::HairScattering(const scene::Hair& hair, const FibrePlace& place, glm::vec3 outgoing) : place_(place) {
    const glm::vec3& x = place.tangent;
    glm::vec3 any = std::abs(x.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    any = core::normalize_or(any - glm::dot(any, x) * x, any);
    towards_ = core::normalize_or(outgoing - glm::dot(outgoing, x) * x, any);
    beside_ = glm::cross(x, towards_);

    // Refract: h is counted against the azimuth.
    const float h = std::clamp(-place.across, -1.0f, 1.0f);
    const float sine = std::clamp(glm::dot(outgoing, x), -1.0f, 1.0f), cosine = core::sqrt_or_zero(1.0f - sine * sine);
    const float ior = std::max(hair.ior, 1.0f + 1e-4f);
    const float cosine_inside = core::sqrt_or_zero(1.0f - sqr(sine / ior));
    const float ior_across = std::sqrt(ior * ior - sine * sine) / std::max(cosine, 1e-4f);
    const float sine_gamma = std::clamp(h / ior_across, -1.0f, 1.0f);
    const float gamma_out = std::asin(h), gamma_in = std::asin(sine_gamma);
    const float way = 2.0f * core::sqrt_or_zero(1.0f - sine_gamma * sine_gamma) / std::max(cosine_inside, 1e-4f);
    const glm::vec3 passing = glm::exp(-hair.absorption * way);

    // Attenuation of each way; the last stands for all longer ones.
    const float f = fresnel_at(cosine * core::sqrt_or_zero(1.0f - h * h), ior);
    lobes_[0].attenuation = glm::vec3(f);
    lobes_[1].attenuation = sqr(1.0f - f) * passing;
    lobes_[2].attenuation = lobes_[1].attenuation * f * passing;
    lobes_[3].attenuation = lobes_[2].attenuation * f * passing / glm::max(glm::vec3(1.0f) - f * passing, 1e-6f);

    const float variance = variance_of(hair.roughness);
    lobes_[0].variance = hair.coat > 0.0f ? variance_of((1.0f - hair.coat) * hair.roughness) : variance;
    lobes_[1].variance = 0.25f * variance;
    lobes_[2].variance = lobes_[3].variance = 4.0f * variance;
    scale_ = scale_of(hair.azimuthal_roughness);
    trim_ = 1.0f / (logistic_sum(pi, scale_) - logistic_sum(-pi, scale_));

    const float tilts[lobes] = {-2.0f * hair.tilt, hair.tilt, 4.0f * hair.tilt, 0.0f};
    float sum = 0.0f;
    for (std::size_t p = 0; p < lobes; ++p) {
        Lobe& lobe = lobes_[p];
        const float c = std::cos(tilts[p]), s = std::sin(tilts[p]);
        lobe.sine = sine * c - cosine * s;
        lobe.cosine = std::abs(cosine * c + sine * s);
        lobe.turn = 2.0f * static_cast<float>(p) * gamma_in - 2.0f * gamma_out + static_cast<float>(p) * pi;
        const float v = lobe.variance = std::max(lobe.variance, 1e-6f);
        // The logarithm of 2 v sinh(1 / v) less 1 / v, which would overflow.
        lobe.shift = -std::log(v * -std::expm1(-2.0f / v));
        sum += lobe.chance = (lobe.attenuation.x + lobe.attenuation.y + lobe.attenuation.z) / 3.0f;
    }
    for (Lobe& lobe : lobes_) lobe.chance = core::divide_or(lobe.chance, sum, 0.25f);
}

HairScattering::Angles HairScattering::angles(glm::vec3 direction) const {
    const float sine = std::clamp(glm::dot(direction, place_.tangent), -1.0f, 1.0f);
    return {sine, core::sqrt_or_zero(1.0f - sine * sine),
            std::atan2(glm::dot(direction, beside_), glm::dot(direction, towards_))};
}

/// M_p [Chiang2016, eq. 4].
float HairScattering::longitudinal(const Lobe& lobe, const Angles& in) {
    const float a = in.cosine * lobe.cosine, b = in.sine * lobe.sine, part = 1.0f / lobe.variance, x = a * part;
    return x < near_bessel ? bessel_near(x) * std::exp(lobe.shift - (b + 1.0f) * part)
                           : bessel_beyond(x) * std::exp(lobe.shift + (a - b - 1.0f) * part);
}

/// N_p [Chiang2016, eq. 5].
float HairScattering::azimuthal(std::size_t p, float azimuth) const {
    if (p + 1 == lobes) return 1.0f / two_pi;
    const float x = std::exp(-std::abs(within_half_turns(azimuth - lobes_[p].turn)) / scale_);
    return trim_ * x / (scale_ * sqr(1.0f + x));
}

Scattered HairScattering::scattered(glm::vec3 to_light) const {
    const Angles in = angles(to_light);
    Scattered sum;
    for (std::size_t p = 0; p < lobes; ++p) {
        const float here = longitudinal(lobes_[p], in) * azimuthal(p, in.azimuth);
        sum.share += here * lobes_[p].attenuation;
        sum.density += here * lobes_[p].chance;
    }
    return sum;
}

/// Chooses a lobe, the angle along the fibre [dEon2013] and that about it.
glm::vec3 HairScattering::sample(float number, glm::vec2 u) const {
    std::size_t p = 0;
    while (p + 1 < lobes && number >= lobes_[p].chance) number -= lobes_[p++].chance;
    // The rest of the number is a number of its own.
    const float left = std::clamp(core::divide_or(number, lobes_[p].chance, 0.0f), 0.0f, 0.9999999f);
    const Lobe& lobe = lobes_[p];
    const float v = lobe.variance, first = std::max(u.x, 1e-7f);
    const float along = 1.0f + v * std::log(first + (1.0f - first) * std::exp(-2.0f / v));
    const float off = core::sqrt_or_zero(1.0f - along * along);
    const float sine = std::clamp(-along * lobe.sine + off * std::cos(two_pi * u.y) * lobe.cosine, -1.0f, 1.0f);
    float turn = two_pi * left;
    if (p + 1 < lobes) {
        const float low = logistic_sum(-pi, scale_);
        const float x = -scale_ * std::log(1.0f / std::clamp(left / trim_ + low, 1e-7f, 1.0f - 1e-7f) - 1.0f);
        turn = lobe.turn + std::clamp(x, -pi, pi);
    }
    const float cosine = core::sqrt_or_zero(1.0f - sine * sine);
    return core::normalize_or(sine * place_.tangent + cosine * (std::cos(turn) * towards_ + std::sin(turn) * beside_),
                              towards_);
}

glm::vec3 HairScattering::albedo() const {
    glm::vec3 sum(0);
    for (const Lobe& lobe : lobes_) sum += lobe.attenuation;
    return sum;
}

float HairScattering::way_out(glm::vec3 direction) const {
    // chosen: at most 20 radii, beyond which strands have bent.
    const float length2 = glm::dot(direction, direction), along = glm::dot(direction, place_.tangent);
    const float sine = core::sqrt_or_zero(1.0f - core::divide_or(along * along, length2, 0.0f));
    const glm::vec3 a = glm::abs(place_.axis);
    return (1.05f * place_.radius / std::max(sine, 0.05f) + 0x1p-20f * std::max({a.x, a.y, a.z})) /
           std::max(std::sqrt(length2), 1e-30f);
}

}  // namespace render2mpeg::renderer
