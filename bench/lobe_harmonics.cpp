#include "bench/lobe_harmonics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::bench {
namespace {

/// Orders of both sets together.
constexpr int most_orders = 10;

/// sqrt((2l+1)/(2 pi) (l-m)!/(l+m)!), times sqrt(2) where m > 0, at l * most_orders + m.
std::array<float, most_orders * most_orders> norms() {
    std::array<float, most_orders * most_orders> norm{};
    for (int l = 0; l < most_orders; ++l)
        for (int m = 0; m <= l; ++m) {
            double ratio = 1;
            for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
            const double square = (2 * l + 1) / (2 * std::numbers::pi) * ratio * (m > 0 ? 2 : 1);
            norm[static_cast<std::size_t>(l * most_orders + m)] = static_cast<float>(std::sqrt(square));
        }
    return norm;
}

/// Where a function is kept; none of a set that has it not.
std::size_t place_of(Basis basis, int l, int m) {
    constexpr std::size_t none = most_coefficients;
    if (basis == Basis::even) return (l + m) % 2 == 0 ? static_cast<std::size_t>(l * (l + 1) / 2 + (l + m) / 2) : none;
    return l < 8 ? static_cast<std::size_t>(l * (l + 1) + m) : none;
}

}  // namespace

int orders_of(Basis basis, int tried) {
    constexpr int stretched[tried_orders] = {3, 4, 5, 6, 7, 8}, even[tried_orders] = {4, 5, 6, 7, 8, 10};
    return basis == Basis::stretched ? stretched[tried] : even[tried];
}

int functions_of(Basis basis, int orders) {
    return basis == Basis::stretched ? orders * orders : orders * (orders + 1) / 2;
}

std::array<float, most_coefficients> harmonics_at(Basis basis, glm::vec3 d) {
    static const auto norm = norms();
    std::array<float, most_coefficients> value{};
    if (!(d.z >= 0.0f)) return value;
    const float z = std::min(d.z, 1.0f), x = basis == Basis::stretched ? 2.0f * z - 1.0f : z;
    const float root = core::sqrt_or_zero(1.0f - x * x), flat = std::hypot(d.x, d.y);
    const float c = core::divide_or(d.x, flat, 1.0f), s = core::divide_or(d.y, flat, 0.0f);
    float pmm = 1, cosine = 1, sine = 0;  // of m times the azimuth
    for (int m = 0; m < most_orders; ++m) {
        float before = 0, p = pmm;
        for (int l = m; l < most_orders; ++l) {
            const float scaled = norm[static_cast<std::size_t>(l * most_orders + m)] * p;
            if (const std::size_t plus = place_of(basis, l, m); plus < value.size()) {
                if (m > 0) value[place_of(basis, l, -m)] = scaled * sine;
                value[plus] = scaled * cosine;
            }
            const auto fl = static_cast<float>(l), fm = static_cast<float>(m);
            const float next = ((2 * fl + 1) * x * p - (fl + fm) * before) / (fl - fm + 1);
            before = p;
            p = next;
        }
        pmm *= static_cast<float>(2 * m + 1) * root;
        const float turned = cosine * c - sine * s;
        sine = sine * c + cosine * s;
        cosine = turned;
    }
    return value;
}

IncidentHarmonics::IncidentHarmonics(Basis basis, glm::vec3 axis) : basis_(basis) {
    glm::vec3 t, b;
    core::make_frame(axis, t, b);
    to_frame_ = glm::transpose(glm::mat3(t, b, axis));
}

void IncidentHarmonics::add(glm::vec3 to_light, float spread2, glm::vec3 irradiance) {
    // Four directions that vary as the disc does: by a quarter of its squared radius along each axis.
    glm::vec3 t, b;
    core::make_frame(to_light, t, b);
    const float aside = std::sqrt(std::min(0.5f * spread2, 1.0f));
    for (const glm::vec3 shift : {aside * t, -aside * t, aside * b, -aside * b}) {
        glm::vec3 d = to_frame_ * glm::normalize(to_light + shift);
        d.z = std::max(d.z, 0.0f);
        const auto value = harmonics_at(basis_, core::normalize_or(d, glm::vec3(0, 0, 1)));
        for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += 0.25f * value[i] * irradiance;
    }
}

LobeHarmonics project_lobe(const IncidentHarmonics& light, glm::vec3 normal, glm::vec3 outgoing, float alpha) {
    constexpr int steps = 40;
    LobeHarmonics result;
    const float a2 = alpha * alpha, nv = glm::dot(normal, outgoing);
    glm::vec3 t, b;
    core::make_frame(normal, t, b);
    for (int k = 0; k < steps * steps; ++k) {
        // Half vectors by their density D n.h, the middles of equal parts of it.
        const float u = (static_cast<float>(k % steps) + 0.5f) / steps,
                    v = (static_cast<float>(k / steps) + 0.5f) / steps;
        const float cos2 = (1.0f - u) / (1.0f + (a2 - 1.0f) * u);
        const float nh = std::sqrt(cos2), sine = core::sqrt_or_zero(1.0f - cos2);
        const float phi = 2 * std::numbers::pi_v<float> * v;
        const glm::vec3 h = sine * std::cos(phi) * t + sine * std::sin(phi) * b + nh * normal;
        const float vh = glm::dot(outgoing, h);
        const glm::vec3 l = 2.0f * vh * h - outgoing;
        const float nl = glm::dot(normal, l);
        if (!(nl > 0.0f) || !(vh > 0.0f) || !(nv > 0.0f)) continue;
        const float share = renderer::lobe::masking(nl, nv, a2) * 4.0f * vh / (nh * steps * steps);
        const float s = renderer::lobe::schlick(vh);
        const auto value = harmonics_at(light.basis(), light.to_frame() * l);
        for (std::size_t i = 0; i < value.size(); ++i) {
            result.f0[i] += share * (1.0f - s) * value[i];
            result.schlick[i] += share * s * value[i];
        }
    }
    return result;
}

glm::vec3 scattered(const IncidentHarmonics& light, const LobeHarmonics& lobe, glm::vec3 f0, int functions) {
    glm::vec3 a(0), b(0);
    for (int i = 0; i < functions; ++i) {
        a += lobe.f0[static_cast<std::size_t>(i)] * light[i];
        b += lobe.schlick[static_cast<std::size_t>(i)] * light[i];
    }
    return f0 * a + b;
}

}  // namespace render2mpeg::bench
