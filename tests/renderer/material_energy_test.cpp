// What materials reflect, against glTF's formula and against an even sky.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sampling.h"
#include "tests/reference/scattering.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

SceneBuilder floor_of(float color, float metallic, float roughness) {
    SceneBuilder b;
    const int m = b.add_material(glm::vec3(color));
    b.material(m).ior = 1.5f;
    b.material(m).metallic = metallic;
    b.material(m).roughness = roughness;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, m);
    b.add_sun({0, -1, 0}, 1.0f);
    return b;
}

glm::vec3 seen_at(float degrees) {
    const float angle = degrees * std::numbers::pi_v<float> / 180.0f;
    return {std::cos(angle), std::sin(angle), 0};
}

GatherPoint point_of(const LitStage& stage, float degrees) {
    return stage.point_at(0, 0, {0.3f, 0.3f}, seen_at(degrees));
}

/// [glTF2, appendix B], of a grey dielectric of index 1.5, per steradian.
double gltf(double color, double roughness, glm::dvec3 n, glm::dvec3 v, glm::dvec3 l) {
    const glm::dvec3 h = glm::normalize(v + l);
    const double nl = glm::dot(n, l), nv = glm::dot(n, v), nh = glm::dot(n, h), vh = glm::dot(v, h);
    const double a2 = std::pow(roughness, 4.0), fresnel = 0.04 + 0.96 * std::pow(1 - vh, 5.0);
    const double d = a2 / (std::numbers::pi * std::pow(nh * nh * (a2 - 1) + 1, 2.0));
    const double visible = 0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
    return (1 - fresnel) * color / std::numbers::pi + fresnel * d * visible;
}

constexpr float angles[] = {3, 5, 10, 20, 45, 70, 90};

TEST(Dielectrics, ScatterAsGltfSays) {
    const glm::vec3 up{0, 1, 0};
    for (const float roughness : {0.4f, 0.5f, 0.75f, 1.0f}) {
        const LitStage stage(floor_of(0.7f, 0, roughness));
        for (const float angle : angles) {
            const SurfacePoint p = point_of(stage, angle).point;
            for (std::uint64_t i = 0; i < 500; ++i) {
                const glm::vec3 l =
                    core::sample_cosine_hemisphere(up, {core::halton(0, i + 1), core::halton(1, i + 1)});
                const double expected = gltf(0.7f, roughness, up, p.outgoing, l);
                EXPECT_NEAR(evaluate(p.bsdf, up, p.outgoing, l).x / expected, 1.0, 0.0101) << roughness << " " << angle;
            }
        }
    }
}

TEST(Dielectrics, UnderAnOverheadSunAreAsBrightAsGltfSays) {
    const glm::dvec3 up{0, 1, 0};
    for (const float roughness : {0.5f, 1.0f}) {
        LitStage stage(floor_of(0.7f, 0, roughness));
        const LightTrees lights = stage.light({16, 0, 0});
        for (const float angle : angles) {
            const double seen = test::gather_all(stage, lights, point_of(stage, angle)).all().x;
            EXPECT_NEAR(seen / gltf(0.7f, roughness, up, glm::dvec3(seen_at(angle)), up), 1.0, 0.0101)
                << roughness << " " << angle;
        }
    }
}

/// What a material sends to the eye of an even light of 1, without interreflection.
double even_light(const SurfacePoint& p) {
    const double cosine = glm::dot(p.shading_normal, p.outgoing);
    const reference::LobeIntegral lobe = reference::integrate_lobe(cosine, p.bsdf.alpha);
    const double passes = p.bsdf.has_glossy() ? 1 - reference::mean_fresnel_power(cosine) : 1.0;
    return p.bsdf.diffuse.x * passes + p.bsdf.f0.x * lobe.f0 + p.bsdf.f90.x * lobe.f90;
}

TEST(Materials, OfWhiteReflectAllOfAnEvenLightSlow) {
    for (const float metallic : {0.0f, 0.5f, 1.0f}) {
        for (const float roughness : {0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f}) {
            const LitStage stage(floor_of(1, metallic, roughness));
            for (const float angle : angles)
                EXPECT_NEAR(even_light(point_of(stage, angle).point), 1.0, 0.02)
                    << metallic << " " << roughness << " " << angle;
        }
    }
}

TEST(Materials, AlbedosAreWhatTheyScatterOfAnEvenLight) {
    for (const float metallic : {0.0f, 1.0f}) {
        for (const float roughness : {0.35f, 1.0f}) {
            const LitStage stage(floor_of(0.6f, metallic, roughness));
            for (const float angle : angles) {
                const SurfacePoint p = point_of(stage, angle).point;
                const float cosine = glm::dot(p.shading_normal, p.outgoing);
                EXPECT_NEAR(diffuse_albedo(p.bsdf, cosine).x + glossy_albedo(p.bsdf, cosine).x, even_light(p), 0.015)
                    << metallic << " " << roughness << " " << angle;
            }
        }
    }
}

TEST(Materials, WithAMirrorReflectNoMoreThanTheyReceive) {
    for (const float metallic : {0.0f, 0.5f}) {
        const LitStage stage(floor_of(1, metallic, 0.0f));
        for (const float angle : angles) {
            const Bsdf bsdf = point_of(stage, angle).point.bsdf;
            EXPECT_FALSE(bsdf.has_glossy());
            EXPECT_GT(bsdf.mirror.x, 0.03f);
            EXPECT_LE(bsdf.diffuse.x + bsdf.mirror.x, 1.0f + 1e-6f);
        }
    }
}

/// A white ball alone in a sky of 1.
class WhiteBall : public testing::TestWithParam<float> {};

TEST_P(WhiteBall, CannotBeToldFromItsSky) {
    SceneBuilder b;
    const int m = b.add_material(glm::vec3(1));
    b.material(m).ior = 1.5f;
    b.material(m).metallic = GetParam();
    b.material(m).roughness = 1.0f;
    b.add_sphere({0, 0, 0}, 1.0f, m, 64);
    b.film().sky.color = glm::vec3(1);
    b.add_camera({0, 0, 6}, {0, 0, 0}, 0.4f);
    Settings settings = test::small_frame(32, 32);
    settings.direct_points = 2000;
    settings.vpls = 0;
    test::FilmStage stage(b, settings);
    const core::Radiance frame = stage.reference();
    for (const glm::vec3& pixel : frame.combined.values()) EXPECT_NEAR(pixel.x, 1.0f, 0.02f);
}
INSTANTIATE_TEST_SUITE_P(Metals, WhiteBall, testing::Values(0.0f, 1.0f));

}  // namespace
}  // namespace render2mpeg::renderer
