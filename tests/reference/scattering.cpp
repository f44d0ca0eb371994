#include "tests/reference/scattering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "scene/preparation/traits.h"

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

/// Integrals of one alpha by the square root of the cosine.
struct Curve {
    static constexpr int count = 64;
    std::array<LobeIntegral, count + 1> at;
    std::array<double, count + 1> power;

    explicit Curve(double alpha) {
        for (std::size_t i = 0; i < at.size(); ++i) {
            const double root = std::max(static_cast<double>(i) / count, 1e-3);
            at[i] = integrate_lobe(root * root, alpha, 64);
            power[i] = mean_fresnel_power(root * root);
        }
    }
};

struct Lookup {
    LobeIntegral lobe;
    double power;
};

Lookup look_up(double cosine, double alpha) {
    thread_local std::map<double, Curve> curves;
    const Curve& curve = curves.try_emplace(alpha, alpha).first->second;
    const double x = Curve::count * std::sqrt(std::clamp(cosine, 0.0, 1.0));
    const auto i = std::min(static_cast<std::size_t>(x), curve.at.size() - 2);
    const double u = x - static_cast<double>(i);
    const auto between = [&](double a, double b) { return a + u * (b - a); };
    return {{between(curve.at[i].f0, curve.at[i + 1].f0), between(curve.at[i].f90, curve.at[i + 1].f90)},
            between(curve.power[i], curve.power[i + 1])};
}

bool is_plain(const scene::Material& m, const scene::Mesh& mesh) {
    return !m.specular_glossiness && mesh.colors.empty() && m.roughness >= scene::mirror_roughness &&
           !m.base_color_texture.present() && !m.metallic_roughness_texture.present() && !m.normal_texture.present() &&
           !(m.transmission > 0);
}

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
    if (f0 == glm::dvec3(0)) return diffuse * (nl / pi);
    const glm::dvec3 h = glm::normalize(to_light + outgoing);
    const double s = fifth_power(glm::dot(outgoing, h));
    const double shown = 1 / (1 + lambda(nl, alpha) + lambda(nv, alpha));
    const double lobe = distribution(glm::dot(normal, h), alpha) * shown / (4 * nv);
    return diffuse * ((1 - s) * nl / pi) + lobe * (f0 * (1 - s) + f90 * s);
}

Scattering metallic_roughness(const scene::Material& m, double cosine) {
    Scattering s;
    const double metal = m.metallic, rough = m.roughness;
    const double interface = std::pow((m.ior - 1.0) / (m.ior + 1.0), 2.0);
    const glm::dvec3 base(glm::clamp(glm::vec3(m.base_color), glm::vec3(0), glm::vec3(1)));
    s.alpha = rough * rough;
    s.diffuse = base * (1 - metal);
    s.f0 = glm::mix(glm::dvec3(interface), base, metal);
    if (s.f0 == glm::dvec3(0)) return s;

    const Lookup e = look_up(cosine, s.alpha);
    const double whole = e.lobe.f0 + e.lobe.f90;
    s.f90 = 1.0 + metal * base * (1 / whole - 1);
    s.f0 = (1 - metal) * interface + metal * base * (1.0 + base * (1 / whole - 1));
    // What glTF's mixing lacks of 1 on a white surface, up to a hundredth; and never more than 1 in all.
    const double under = (1 - interface) * (1 - e.power);
    const double lack = (1 - interface * e.lobe.f0 - e.lobe.f90) / under;
    s.diffuse *= (1 - interface) * std::clamp(lack, 1.0, 1.01);
    for (int c = 0; c < 3; ++c) {
        const double left = 1 - s.f0[c] * e.lobe.f0 - s.f90[c] * e.lobe.f90;
        s.diffuse[c] = std::min(s.diffuse[c], std::max(left, 0.0) / (1 - e.power));
    }
    return s;
}

Scattering scattering_of(const scene::Animation& animation, const renderer::SurfacePoint& p) {
    const scene::Material& material = animation.materials[p.material];
    const auto mesh = static_cast<std::size_t>(animation.objects[p.address.object].mesh);
    if (is_plain(material, animation.meshes[mesh]))
        return metallic_roughness(material, glm::dot(glm::dvec3(p.shading_normal), glm::dvec3(p.outgoing)));
    return {glm::dvec3(p.bsdf.diffuse), glm::dvec3(p.bsdf.f0), glm::dvec3(p.bsdf.f90), p.bsdf.alpha};
}

}  // namespace render2mpeg::reference
