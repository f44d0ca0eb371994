#include "tests/reference/scattering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace render2mpeg::reference {
namespace {

constexpr double pi = std::numbers::pi;

double fifth_power(double cosine) {
    return std::pow(std::clamp(1.0 - cosine, 0.0, 1.0), 5.0);
}

/// Smith's masking of one direction [Walter2007, eq. 34].
double masked(double cosine, double alpha) {
    const double tangent2 = 1.0 / (cosine * cosine) - 1.0;
    return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * tangent2));
}

/// Lambda of [Heitz2014, eq. 72].
double lambda(double cosine, double alpha) {
    return 1.0 / masked(cosine, alpha) - 1.0;
}

double distribution(double cosine, double alpha) {
    const double a2 = alpha * alpha, c2 = cosine * cosine;
    return a2 / (pi * std::pow(c2 * (a2 - 1.0) + 1.0, 2.0));
}

/// A visible normal for a view in the plane y = 0 [Heitz2018].
glm::dvec3 visible_normal(double cosine, double alpha, double u1, double u2) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const glm::dvec3 v = glm::normalize(glm::dvec3(alpha * sine, 0, cosine));
    const glm::dvec3 t1(0, 1, 0), t2 = glm::cross(v, t1);
    const double r = std::sqrt(u1), phi = 2 * pi * u2, s = 0.5 * (1 + v.z);
    const double p1 = r * std::cos(phi), p2 = (1 - s) * std::sqrt(1 - p1 * p1) + s * r * std::sin(phi);
    const glm::dvec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * v;
    return glm::normalize(glm::dvec3(alpha * n.x, alpha * n.y, std::max(0.0, n.z)));
}

/// A function of the square root of a cosine, tabulated.
template <class Value>
struct Curve {
    static constexpr int count = 64;
    std::array<Value, count + 1> at;

    template <class Function>
    explicit Curve(const Function& function) {
        for (std::size_t i = 0; i < at.size(); ++i) {
            const double root = std::max(static_cast<double>(i) / count, 1e-3);
            at[i] = function(root * root);
        }
    }

    Value operator()(double cosine) const {
        const double x = count * std::sqrt(std::clamp(cosine, 0.0, 1.0));
        const auto i = std::min(static_cast<std::size_t>(x), at.size() - 2);
        const double u = x - static_cast<double>(i);
        return at[i] * (1 - u) + at[i + 1] * u;
    }
};

/// (f0, f90) of LobeIntegral.
glm::dvec2 lobe_at(double cosine, double alpha) {
    thread_local std::map<double, Curve<glm::dvec2>> curves;
    const auto known = curves.find(alpha);
    if (known != curves.end()) return known->second(cosine);
    const auto integral = [&](double c) {
        const LobeIntegral e = integrate_lobe(c, alpha, 64);
        return glm::dvec2(e.f0, e.f90);
    };
    return curves.emplace(alpha, integral).first->second(cosine);
}

double mean_power_at(double cosine) {
    static const Curve<double> curve(mean_fresnel_power);
    return curve(cosine);
}

/// [Schlick1994, eq. 15]; what reflects nothing at normal incidence is no interface.
double fresnel(double f0, double cosine) {
    return f0 > 0 ? f0 + (1 - f0) * fifth_power(cosine) : 0.0;
}

double largest(glm::dvec3 v) {
    return std::max({v.x, v.y, v.z});
}

/// Two unit vectors at right angles to n and to one another.
void frame_of(glm::dvec3 n, glm::dvec3& t, glm::dvec3& b) {
    const glm::dvec3 other = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    t = glm::normalize(glm::cross(other, n));
    b = glm::cross(n, t);
}

/// Makes the lobe whole, and lays the Lambert part below it. `coat`: what the interface of the rest reflects at normal
/// incidence; `metal` of the surface reflects `metal_f0` and has nothing below.
void lay_lobe(Scattering& s, double coat, double metal, glm::dvec3 metal_f0, double cosine) {
    const glm::dvec2 e = lobe_at(cosine, s.alpha);
    const double power = mean_power_at(cosine);
    const glm::dvec3 regained = metal * metal_f0 * (1 / (e.x + e.y) - 1);
    s.f90 = 1.0 + regained;
    s.f0 += metal_f0 * regained;
    // What glTF's mixing lacks of 1 on a white surface, up to a hundredth; and never more than 1 in all.
    const double under = (1 - coat) * (1 - power);
    const double lack = under > 0 ? (1 - coat * e.x - e.y) / under : 1.0;
    s.diffuse *= (1 - coat) * std::clamp(lack, 1.0, 1.01);
    for (int c = 0; c < 3; ++c) {
        const double left = 1 - s.f0[c] * e.x - s.f90[c] * e.y - s.transmission[c];
        s.diffuse[c] = std::min(s.diffuse[c], std::max(left, 0.0) / (1 - power));
    }
}

void lay_mirror(Scattering& s, double coat, double cosine) {
    for (int c = 0; c < 3; ++c) s.mirror[c] = fresnel(s.f0[c], cosine);
    s.f0 = glm::dvec3(0);
    s.diffuse *= (1 - coat) * (1 - mean_power_at(cosine));
    for (int c = 0; c < 3; ++c)
        s.diffuse[c] = std::min(s.diffuse[c], std::max(1 - s.mirror[c] - s.transmission[c], 0.0));
}

/// Smoother surfaces have a mirror in place of a lobe (docs/model/materials.md).
constexpr double mirror_below = 0.1;

}  // namespace

LobeIntegral integrate_lobe(double cosine, double alpha, int steps) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    LobeIntegral sum;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const glm::dvec3 h = visible_normal(cosine, alpha, (i + 0.5) / steps, (j + 0.5) / steps);
            const double vh = h.x * sine + h.z * cosine, nl = 2 * vh * h.z - cosine;
            if (!(vh > 0) || !(nl > 0)) continue;
            const double share = (1 + lambda(cosine, alpha)) / (1 + lambda(cosine, alpha) + lambda(nl, alpha));
            sum.f0 += share * (1 - fifth_power(vh));
            sum.f90 += share * fifth_power(vh);
        }
    }
    const double count = static_cast<double>(steps) * steps;
    return {sum.f0 / count, sum.f90 / count};
}

double mean_fresnel_power(double cosine) {
    constexpr int steps = 200;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const double u = (i + 0.5) / steps, phi = pi * (j + 0.5) / steps;
            const double lv = std::sqrt(u) * std::cos(phi) * sine + std::sqrt(1 - u) * cosine;
            sum += fifth_power(std::sqrt(0.5 * (1 + lv)));
        }
    }
    return sum / (static_cast<double>(steps) * steps);
}

glm::dvec3 Scattering::times_cosine(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 to_light) const {
    const double nl = glm::dot(normal, to_light), nv = glm::dot(normal, outgoing);
    if (!(nl > 0) || !(nv > 0)) return glm::dvec3(0);
    if (!has_lobe()) return diffuse * (nl / pi);
    const glm::dvec3 h = glm::normalize(to_light + outgoing);
    const double s = fifth_power(glm::dot(outgoing, h));
    const double shown = 1 / (1 + lambda(nl, alpha) + lambda(nv, alpha));
    const double lobe = distribution(glm::dot(normal, h), alpha) * shown / (4 * nv);
    return diffuse * ((1 - s) * nl / pi) + lobe * (f0 * (1 - s) + f90 * s);
}

glm::dvec3 Scattering::sample(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 u) const {
    glm::dvec3 t, b;
    frame_of(normal, t, b);
    if (!has_lobe() || u.z < 0.5) {
        const double r = std::sqrt(u.x), phi = 2 * pi * u.y;
        return glm::normalize(r * std::cos(phi) * t + r * std::sin(phi) * b + std::sqrt(1 - u.x) * normal);
    }
    // The frame in which the view has no y.
    const double cosine = glm::dot(normal, outgoing);
    const glm::dvec3 along = outgoing - cosine * normal;
    if (glm::length(along) > 1e-9) {
        t = glm::normalize(along);
        b = glm::cross(normal, t);
    }
    const glm::dvec3 h = visible_normal(std::min(cosine, 1.0), alpha, u.x, u.y);
    const glm::dvec3 half = h.x * t + h.y * b + h.z * normal;
    return glm::normalize(2 * glm::dot(outgoing, half) * half - outgoing);
}

double Scattering::density(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 to_light) const {
    const double nl = glm::dot(normal, to_light), nv = glm::dot(normal, outgoing);
    const double by_cosine = std::max(nl, 0.0) / pi;
    if (!has_lobe()) return by_cosine;
    const glm::dvec3 h = glm::normalize(to_light + outgoing);
    const double by_lobe = masked(nv, alpha) * distribution(glm::dot(normal, h), alpha) / (4 * nv);
    return 0.5 * by_cosine + 0.5 * by_lobe;
}

Scattering scattering_of(const Look& look, double cosine) {
    Scattering s;
    if (look.unlit) return s;
    const double index = (look.ior - 1.0) / (look.ior + 1.0);
    double coat = index * index, metal = look.metallic;
    glm::dvec3 metal_f0 = look.base;
    if (look.specular_glossiness) {
        coat = largest(look.specular);
        metal = 1 - largest(look.base);
        metal_f0 = s.f0 = look.specular;
        s.diffuse = look.base;
    } else {
        s.f0 = glm::mix(glm::dvec3(coat), look.base, metal);
        s.diffuse = look.base * ((1 - metal) * (1 - look.transmission));
        s.transmission = look.base * ((1 - metal) * look.transmission * (1 - fresnel(coat, cosine)));
    }
    s.alpha = look.roughness * look.roughness;
    if (!s.has_lobe()) return s;
    if (look.roughness < mirror_below)
        lay_mirror(s, coat, cosine);
    else
        lay_lobe(s, coat, metal, metal_f0, cosine);
    return s;
}

Scattering metallic_roughness(const scene::Material& m, double cosine) {
    Look look;
    look.base = glm::clamp(glm::vec3(m.base_color), glm::vec3(0), glm::vec3(1));
    look.metallic = m.metallic;
    look.roughness = m.roughness;
    look.ior = m.ior;
    look.transmission = m.transmission;
    return scattering_of(look, cosine);
}

}  // namespace render2mpeg::reference
