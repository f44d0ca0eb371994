// Materials with layers: KHR_materials_specular, KHR_materials_sheen, KHR_materials_clearcoat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sampling.h"
#include "renderer/surface/sheen.h"
#include "renderer/surface/thin_film.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// A floor of index 1.5 and roughness 0.6, under a sun, with what `change` does to its material.
template <class Change>
SceneBuilder layered_floor(const Change& change) {
    SceneBuilder b;
    const int m = b.add_material(glm::vec3(0.5f));
    b.material(m).ior = 1.5f;
    b.material(m).roughness = 0.6f;
    change(b.material(m));
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, m);
    b.add_sun({0, -1, 0}, 1.0f);
    return b;
}

SurfacePoint seen_from(const LitStage& stage, float degrees) {
    const float angle = degrees * std::numbers::pi_v<float> / 180;
    return stage.point_at(0, 0, {0.3f, 0.3f}, {std::cos(angle), std::sin(angle), 0}).point;
}

float schlick(float f0, float f90, float cosine) {
    return f0 + (f90 - f0) * std::pow(1 - cosine, 5.0f);
}

/// [KHR_materials_specular, "Implementation"], per steradian, of one channel of grey 0.5.
float specular_formula(float weight, float tint, glm::vec3 n, glm::vec3 v, glm::vec3 l) {
    const glm::vec3 h = glm::normalize(v + l);
    const float nl = glm::dot(n, l), nv = glm::dot(n, v), nh = glm::dot(n, h), vh = glm::dot(v, h);
    const float a2 = std::pow(0.6f, 4.0f);
    const float d = a2 / (std::numbers::pi_v<float> * std::pow(nh * nh * (a2 - 1) + 1, 2.0f));
    const float visible = 0.5f / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
    const float own = weight * schlick(std::min(0.04f * tint, 1.0f), 1, vh);
    const float most = weight * schlick(std::min(0.04f * std::max(tint, 2.0f), 1.0f), 1, vh);
    return (1 - most) * 0.5f / std::numbers::pi_v<float> + own * d * visible;
}

TEST(Specular, ScattersAsItsFormulaSays) {
    const glm::vec3 up{0, 1, 0};
    for (const float weight : {1.0f, 0.5f}) {
        const LitStage stage(layered_floor([&](scene::Material& m) {
            m.specular_weight = weight;
            m.specular_tint = {2, 1, 0.5f};
        }));
        for (const float angle : {20.0f, 45.0f, 90.0f}) {
            const SurfacePoint p = seen_from(stage, angle);
            for (std::uint64_t i = 0; i < 200; ++i) {
                const glm::vec3 l =
                    core::sample_cosine_hemisphere(up, {core::halton(0, i + 1), core::halton(1, i + 1)});
                const glm::vec3 f = evaluate(p.bsdf, up, p.outgoing, l);
                // A light and an eye that both graze share the loss at grazing angles, which is right on average.
                const float within = weight < 1 ? 0.07f : 0.011f;
                EXPECT_NEAR(f.x / specular_formula(weight, 2, up, p.outgoing, l), 1, within) << angle;
                EXPECT_NEAR(f.z / specular_formula(weight, 0.5f, up, p.outgoing, l), 1, within) << angle;
            }
        }
    }
}

TEST(Specular, OfNoneIsALambertSurface) {
    const LitStage stage(layered_floor([](scene::Material& m) { m.specular_weight = 0; }));
    const Bsdf bsdf = seen_from(stage, 30).bsdf;
    EXPECT_FALSE(bsdf.has_glossy());
    EXPECT_FLOAT_EQ(bsdf.diffuse.x, 0.5f);
}

/// Charlie's integral over light directions, by other points than the table's.
double charlie(double nv, double roughness) {
    const double alpha = roughness * roughness;
    const auto fit = [&](double x) {
        const double t = (1 - alpha) * (1 - alpha);
        const auto mix = [&](double p, double q) { return p + (q - p) * t; };
        return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * std::pow(x, mix(0.19823, 0.16801))) +
               mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967);
    };
    const auto lambda = [&](double c) { return c < 0.5 ? std::exp(fit(c)) : std::exp(2 * fit(0.5) - fit(1 - c)); };
    constexpr int n = 120;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            const double nl = (i + 0.5) / n, phi = std::numbers::pi * (k + 0.5) / n;
            const glm::dvec3 v(std::sqrt(1 - nv * nv), 0, nv),
                l(std::sqrt(1 - nl * nl) * std::cos(phi), std::sqrt(1 - nl * nl) * std::sin(phi), nl),
                h = glm::normalize(v + l);
            const double d =
                (2 + 1 / alpha) * std::pow(std::sqrt(std::max(0.0, 1 - h.z * h.z)), 1 / alpha) / (2 * std::numbers::pi);
            sum += d * std::min(1.0, 1 / ((1 + lambda(nv) + lambda(nl)) * 4 * nv * nl)) * nl;
        }
    return sum * 2 * std::numbers::pi / (n * n);
}

TEST(Sheen, ItsAlbedoIsTheIntegralOfItsFormula) {
    for (const double cosine : {0.05, 0.2, 0.5, 0.8, 1.0})
        for (const double roughness : {0.2, 0.45, 0.7, 1.0})
            EXPECT_NEAR(sheen_albedo(static_cast<float>(cosine), static_cast<float>(roughness)),
                        charlie(cosine, roughness), 0.02)
                << cosine << " " << roughness;
}

TEST(Sheen, OfBlenderFourIsThatOfItsBalls) {
    // In an even world, by Cycles of Blender 4.5.
    struct Seen {
        float roughness, cosine, albedo;
    };
    for (const Seen& seen : {Seen{0.2f, 0.113f, 0.2694f},
                             {0.2f, 0.213f, 0.0745f},
                             {0.2f, 0.963f, 0.0001f},
                             {0.5f, 0.113f, 0.5376f},
                             {0.5f, 0.413f, 0.2131f},
                             {0.5f, 0.963f, 0.0224f},
                             {1.0f, 0.113f, 0.6922f},
                             {1.0f, 0.413f, 0.538f},
                             {1.0f, 0.963f, 0.3502f}})
        EXPECT_NEAR(microfibre_albedo(seen.cosine, seen.roughness), seen.albedo, 0.01f)
            << seen.roughness << " " << seen.cosine;
    for (const float roughness : {0.0f, 0.1f, 0.15f, 0.3f, 0.6f, 1.0f}) {
        EXPECT_LT(microfibre_albedo(0, roughness), 0.8f) << roughness;
        for (int k = 1; k < 64; ++k) {
            const float cosine = static_cast<float>(k) / 64;
            EXPECT_LE(microfibre_albedo(cosine, roughness), microfibre_albedo(cosine - 1.0f / 64, roughness) + 1e-3f)
                << roughness << " " << cosine;
        }
    }
}

TEST(Sheen, RisesTowardsGrazingAnglesAndTakesFromBelow) {
    const LitStage plain(layered_floor([](scene::Material&) {})), cloth(layered_floor([](scene::Material&m) {
        m.sheen = {1, 0, 0};
        m.sheen_roughness = 0.5f;
    }));
    const Bsdf above = seen_from(cloth, 90).bsdf, grazing = seen_from(cloth, 10).bsdf;
    EXPECT_GT(grazing.diffuse.x, above.diffuse.x + 0.1f);
    EXPECT_LT(grazing.diffuse.y, seen_from(plain, 10).bsdf.diffuse.y);
    for (const float angle : {3.0f, 10.0f, 45.0f, 90.0f}) {
        const SurfacePoint p = seen_from(cloth, angle);
        const float cosine = glm::dot(p.shading_normal, p.outgoing);
        EXPECT_LE(diffuse_albedo(p.bsdf, cosine).x + glossy_albedo(p.bsdf, cosine).x, 1.02f) << angle;
    }
}

TEST(Clearcoat, OfSmoothKindMirrorsAndDimsWhatItCovers) {
    const LitStage plain(layered_floor([](scene::Material&) {})),
        coated(layered_floor([](scene::Material&m) { m.coat = 0.5f; }));
    for (const float angle : {10.0f, 45.0f, 90.0f}) {
        const Bsdf below = seen_from(plain, angle).bsdf, bsdf = seen_from(coated, angle).bsdf;
        const float reflected = 0.5f * schlick(0.04f, 1, std::sin(angle * std::numbers::pi_v<float> / 180));
        EXPECT_NEAR(bsdf.mirror.x, reflected, 1e-4f);
        EXPECT_NEAR(bsdf.diffuse.x, (1 - reflected) * below.diffuse.x, 1e-5f);
        EXPECT_NEAR(bsdf.f0.x, (1 - reflected) * below.f0.x, 1e-5f);
    }
}

TEST(Clearcoat, OfRoughKindIsTheLobe) {
    const LitStage coated(layered_floor([](scene::Material& m) {
        m.coat = 1;
        m.coat_roughness = 0.3f;
    }));
    for (const float angle : {10.0f, 45.0f, 90.0f}) {
        const SurfacePoint p = seen_from(coated, angle);
        EXPECT_FLOAT_EQ(p.bsdf.alpha, 0.09f);
        EXPECT_FLOAT_EQ(p.bsdf.f0.x, 0.04f);
        const float cosine = glm::dot(p.shading_normal, p.outgoing);
        EXPECT_LE(diffuse_albedo(p.bsdf, cosine).x + glossy_albedo(p.bsdf, cosine).x, 1.02f) << angle;
    }
}

TEST(Clearcoat, OverMetalMirrors) {
    const LitStage coated(layered_floor([](scene::Material& m) {
        m.metallic = 1;
        m.coat = 1;
        m.coat_roughness = 0.3f;
    }));
    const Bsdf bsdf = seen_from(coated, 90).bsdf;
    EXPECT_NEAR(bsdf.mirror.x, 0.04f, 1e-4f);
    EXPECT_FLOAT_EQ(bsdf.alpha, 0.36f);
}

TEST(ThinFilm, OfNoThicknessChangesNothing) {
    for (const float f0 : {0.04f, 0.5f, 0.9f}) EXPECT_NEAR(thin_film(1.3f, 0, 1, glm::vec3(f0)).y, f0, 0.01f) << f0;
}

TEST(ThinFilm, InterferesByItsThickness) {
    // Between air and glass a film of an index between theirs cancels where it is a quarter of a wave thick, and adds
    // up at half a wave: green at 100 and 212 nm of index 1.3.
    const float quarter = thin_film(1.3f, 106, 1, glm::vec3(0.08f)).y,
                half = thin_film(1.3f, 212, 1, glm::vec3(0.08f)).y;
    EXPECT_LT(quarter, 0.02f);
    EXPECT_GT(half, 0.06f);
    // Thick films have no colour.
    const glm::vec3 thick = thin_film(1.3f, 20000, 1, glm::vec3(0.08f));
    EXPECT_NEAR(thick.x, thick.y, 2e-3f);
    EXPECT_NEAR(thick.z, thick.y, 2e-3f);
}

TEST(ThinFilm, ColoursTheReflectionOfASurface) {
    const LitStage film(layered_floor([](scene::Material& m) {
        m.metallic = 1;
        m.iridescence = 1;
        m.film_thickest = 400;
    }));
    const Bsdf above = seen_from(film, 90).bsdf, slanted = seen_from(film, 40).bsdf;
    const glm::vec3 expected = thin_film(1.3f, 400, 1, glm::vec3(0.5f));
    EXPECT_NEAR(above.f0.x / above.f0.y, expected.x / expected.y, 0.05f);
    EXPECT_GT(std::abs(above.f0.x / above.f0.z - slanted.f0.x / slanted.f0.z), 0.05f);
}

TEST(ThinFilm, SchlicksTermFindsItsWayBack) {
    EXPECT_NEAR(schlick_f0(glm::vec3(schlick(0.3f, 1, 0.4f)), 0.4f).x, 0.3f, 1e-5f);
}

}  // namespace
}  // namespace render2mpeg::renderer
