// Blender's models of surfaces: their parts against integrals, and their energy under an even sky.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "core/sampling.h"
#include "renderer/surface/dielectric.h"
#include "renderer/surface/lobe_moments.h"
#include "renderer/surface/principled.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

constexpr double pi = std::numbers::pi;
constexpr float heights_looked_at[] = {0.05f, 0.1f, 0.3f, 0.6f, 0.9f, 1.0f};

/// Mean over the hemisphere with the cosine of `of(nl, lv)`, seen at a cosine; z is the normal.
template <class Of>
double mean_over_light(double nv, const Of& of) {
    constexpr int heights = 400, turns = 200;
    const double across = std::sqrt(1 - nv * nv);
    double sum = 0;
    for (int i = 0; i < heights; ++i)
        for (int k = 0; k < turns; ++k) {
            const double nl = std::sqrt((i + 0.5) / heights), phi = pi * (k + 0.5) / turns;
            sum += of(nl, nl * nv + std::sqrt(1 - nl * nl) * across * std::cos(phi));
        }
    return sum / (heights * turns);
}

/// What a surface reflects of an even light, by its f_s.
glm::dvec3 reflected(const Bsdf& bsdf, float nv) {
    const glm::vec3 up{0, 0, 1}, eye{std::sqrt(1 - nv * nv), 0, nv};
    glm::dvec3 sum(0);
    constexpr int count = 20000;
    for (std::uint64_t i = 0; i < count; ++i) {
        const glm::vec2 u{core::halton(0, i + 1), core::halton(1, i + 1)};
        sum += bsdf.has_lobe() ? glm::dvec3(sample_glossy(bsdf, up, eye, u).weight) : glm::dvec3(0);
        sum += glm::dvec3(diffuse_weight(bsdf, up, eye, core::sample_cosine_hemisphere(up, u)));
    }
    return sum / static_cast<double>(count);
}

TEST(DiffuseShape, HasTheAlbedoOfItsIntegral) {
    for (const float roughness : {0.0f, 0.3f, 1.0f})
        for (const DiffuseShape& shape : {DiffuseShape::disney(roughness), DiffuseShape::oren_nayar(roughness)})
            for (const float nv : heights_looked_at) {
                const double mean = mean_over_light(nv, [&](double nl, double lv) {
                    return shape.value(static_cast<float>(nl), nv, static_cast<float>(lv));
                });
                EXPECT_NEAR(shape.albedo(nv), mean, 2e-3) << roughness << " " << nv;
            }
}

TEST(DiffuseShape, OfDisneyIsBurleysFormula) {
    // [Burley2012, 5.3]
    for (const double roughness : {0.2, 0.9})
        for (const double nl : {0.1, 0.5, 0.9})
            for (const double nv : {0.15, 0.8}) {
                const double lv = nl * nv - 0.3 * std::sqrt((1 - nl * nl) * (1 - nv * nv));
                const double f90 = 0.5 + 2 * roughness * 0.5 * (1 + lv);
                const double expected =
                    (1 + (f90 - 1) * std::pow(1 - nl, 5.0)) * (1 + (f90 - 1) * std::pow(1 - nv, 5.0));
                EXPECT_NEAR(DiffuseShape::disney(static_cast<float>(roughness))
                                .value(static_cast<float>(nl), static_cast<float>(nv), static_cast<float>(lv)),
                            expected, 1e-5);
            }
}

TEST(LobeMoments, AreTheIntegralsOfTheLobeSlow) {
    // D V cos by directions of light, in double precision [Walter2007, eq. 33; Heitz2014, eqs. 98, 99].
    const double root = 0.2, f0 = root * root;
    for (const double roughness : {0.5, 0.8, 1.0})
        for (const double nv : {0.2, 0.5, 0.9}) {
            const double a2 = std::pow(roughness, 4.0);
            const auto lobe = [&](bool separable, auto&& of) {
                return pi * mean_over_light(nv, [&](double nl, double lv) {
                           const double nh = (nl + nv) / std::sqrt(2 + 2 * lv), vh = std::sqrt(0.5 * (1 + lv));
                           const double d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2.0));
                           const auto lambda = [&](double c) {
                               return 0.5 * (std::sqrt(1 + a2 * (1 / (c * c) - 1)) - 1);
                           };
                           const double g = separable ? 1 / ((1 + lambda(nl)) * (1 + lambda(nv)))
                                                      : 1 / (1 + lambda(nl) + lambda(nv));
                           return d * g / (4 * nl * nv) * of(vh);
                       });
            };
            const auto relative = [&](double vh) {
                return (dielectric_reflectance(static_cast<float>(vh), 1.5f) - f0) / (1 - f0);
            };
            for (const bool separable : {false, true}) {
                const LobeMoments m =
                    lobe_moments(static_cast<float>(nv), static_cast<float>(roughness * roughness),
                                 static_cast<float>(root), separable ? Masking::separable : Masking::correlated);
                EXPECT_NEAR(m.whole, lobe(separable, [](double) { return 1.0; }), 0.004) << roughness << " " << nv;
                EXPECT_NEAR(m.fresnel, lobe(separable, relative), 0.001) << roughness << " " << nv;
                EXPECT_NEAR(m.edge, lobe(false, [](double c) { return c * std::pow(1 - c, 6.0); }), 0.001);
            }
        }
}

Bsdf principled(PrincipledInputs in) {
    Bsdf bsdf;
    bsdf.alpha = in.roughness * in.roughness;
    bsdf.diffuse = in.base * ((1 - in.metallic) * (1 - in.transmission));
    reflect_as_principled(in, bsdf);
    return bsdf;
}

TEST(Principled, OfBlenderFourWithAWhiteBaseKeepsAllEnergy) {
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.2f, 0.5f, 0.8f, 1.0f})
            for (const float cosine : heights_looked_at) {
                PrincipledInputs in{scene::SurfaceModel::principled_4, glm::vec3(1), metallic, roughness};
                in.cosine = cosine;
                in.multiscatter = true;
                const Bsdf bsdf = principled(in);
                const double albedo = diffuse_albedo(bsdf, cosine).x + glossy_albedo(bsdf, cosine).x;
                EXPECT_NEAR(albedo, 1, 0.01) << metallic << " " << roughness << " " << cosine;
                EXPECT_NEAR(reflected(bsdf, cosine).x, 1, 0.02) << metallic << " " << roughness << " " << cosine;
            }
}

TEST(Principled, ReflectsWhatItsAlbedosSay) {
    for (const auto model : {scene::SurfaceModel::principled_3, scene::SurfaceModel::principled_4})
        for (const float roughness : {0.3f, 0.9f})
            for (const float cosine : heights_looked_at) {
                PrincipledInputs in{model, {0.8f, 0.4f, 0.1f}, 0.3f, roughness};
                in.cosine = cosine;
                const Bsdf bsdf = principled(in);
                const glm::dvec3 whole(diffuse_albedo(bsdf, cosine) + glossy_albedo(bsdf, cosine)),
                    sum = reflected(bsdf, cosine);
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(whole[c], sum[c], 0.015) << roughness << " " << cosine;
            }
}

/// Cycles 3.4.1's: a plane under a white sky, one bounce, 256 samples a pixel: base black with specular 0.5, and base
/// white with specular 0; at 90, 40 and 10 degrees.
TEST(Principled, OfBlenderThreeReflectsWhatCyclesHasOfAnEvenSky) {
    struct Seen {
        float roughness;
        double degrees, lobe, diffuse;
    };
    for (const Seen& seen :
         {Seen{0.3f, 90, 0.0397, 0.9941}, Seen{0.3f, 40, 0.0581, 0.9924}, Seen{0.3f, 10, 0.2682, 0.9288},
          Seen{0.6f, 90, 0.0336, 1.0119}, Seen{0.6f, 40, 0.0438, 1.0115}, Seen{0.6f, 10, 0.1, 1.0745},
          Seen{0.9f, 90, 0.0173, 1.0297}, Seen{0.9f, 40, 0.023, 1.0307}, Seen{0.9f, 10, 0.0441, 1.2254}}) {
        const auto cosine = static_cast<float>(std::sin(seen.degrees * pi / 180));
        PrincipledInputs in{scene::SurfaceModel::principled_3, glm::vec3(1), 0, seen.roughness};
        in.cosine = cosine;
        const Bsdf bsdf = principled(in);
        EXPECT_NEAR(glossy_albedo(bsdf, cosine).x, seen.lobe, 0.0015) << seen.roughness << " " << seen.degrees;
        EXPECT_NEAR(diffuse_albedo(bsdf, cosine).x, seen.diffuse, 0.0005) << seen.roughness << " " << seen.degrees;
    }
}

/// Likewise: a black base with a clear coat of roughness 0.03 and 0.3, at 40, 15 and 10 degrees.
TEST(Principled, OfBlenderThreeHasTheCoatThatCyclesHas) {
    struct Seen {
        float roughness;
        double degrees, coat;
    };
    scene::Material material;
    material.model = scene::SurfaceModel::principled_3;
    for (const Seen& seen : {Seen{0.03f, 40, 0.0141}, Seen{0.03f, 15, 0.0534}, Seen{0.03f, 10, 0.0709},
                             Seen{0.3f, 40, 0.014}, Seen{0.3f, 15, 0.043}, Seen{0.3f, 10, 0.0535}}) {
        const auto cosine = static_cast<float>(std::sin(seen.degrees * pi / 180));
        Bsdf bsdf;
        lay_coat(material, {0.25f, seen.roughness, cosine}, bsdf);
        EXPECT_NEAR(glossy_albedo(bsdf, cosine).x + bsdf.mirror.x, seen.coat, 0.002)
            << seen.roughness << " " << seen.degrees;
    }
}

/// Likewise: gold of roughness 0.7 with multiple scattering, at 40 degrees.
TEST(Principled, OfBlenderThreeFollowsLightAmongFacetsAsCyclesDoes) {
    const auto cosine = static_cast<float>(std::sin(40 * pi / 180));
    PrincipledInputs in{scene::SurfaceModel::principled_3, {0.9f, 0.65f, 0.3f}, 1, 0.7f};
    in.cosine = cosine;
    in.multiscatter = true;
    const glm::vec3 seen = glossy_albedo(principled(in), cosine);
    const glm::vec3 cycles{0.8738f, 0.5873f, 0.2492f};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], cycles[c], 0.006) << c;
}

TEST(Principled, IsNeverBrighterThanItsLight) {
    for (const auto model : {scene::SurfaceModel::principled_3, scene::SurfaceModel::principled_4})
        for (const float coat : {0.0f, 1.0f})
            for (const float roughness : {0.05f, 0.4f, 1.0f}) {
                SceneBuilder b;
                const int m = b.add_material(glm::vec3(1));
                scene::Material& material = b.material(m);
                material.specular_glossiness = false;
                material.model = model;
                material.roughness = roughness;
                material.coat = material.coat_roughness = coat;
                material.sheen = glm::vec3(coat);
                b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, m);
                b.add_sun({0, -1, 0}, 1.0f);
                const LitStage stage(b);
                for (const float cosine : heights_looked_at) {
                    const glm::vec3 eye{std::sqrt(1 - cosine * cosine), cosine, 0};
                    const Bsdf bsdf = stage.point_at(0, 0, {0.3f, 0.3f}, eye).point.bsdf;
                    const float albedo = diffuse_albedo(bsdf, cosine).x + glossy_albedo(bsdf, cosine).x + bsdf.mirror.x;
                    EXPECT_LE(albedo, 1.0f + 1e-4f) << coat << " " << roughness << " " << cosine;
                    EXPECT_GT(albedo, 0.75f) << coat << " " << roughness << " " << cosine;
                }
            }
}

TEST(RoughDiffuse, OfBlenderFourKeepsTheEnergyOfWhite) {
    scene::Material material;
    material.model = scene::SurfaceModel::principled_4;
    material.diffuse_roughness = 1;
    for (const float cosine : heights_looked_at) {
        Bsdf white, grey;
        white.diffuse = glm::vec3(1);
        grey.diffuse = glm::vec3(0.5f);
        roughen(material, white.diffuse, cosine, white);
        roughen(material, grey.diffuse, cosine, grey);
        EXPECT_NEAR(diffuse_albedo(white, cosine).x, 1, 0.01) << cosine;
        EXPECT_LT(diffuse_albedo(grey, cosine).x, 0.5f) << cosine;
    }
    // A ball in an even world, by Cycles of Blender 4.3 and 4.5.
    const std::pair<float, glm::vec3> seen[] = {
        {0.2f, {0.8901f, 0.5788f, 0.1898f}}, {0.6f, {0.8704f, 0.5362f, 0.1692f}}, {0.97f, {0.8588f, 0.5111f, 0.1571f}}};
    for (const auto& [cosine, albedo] : seen) {
        Bsdf bsdf;
        bsdf.diffuse = {0.9f, 0.6f, 0.2f};
        roughen(material, bsdf.diffuse, cosine, bsdf);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(diffuse_albedo(bsdf, cosine)[c], albedo[c], 0.003f) << cosine;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
