// Materials beyond one round lobe: KHR_materials_diffuse_transmission, KHR_materials_anisotropy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::LitStage;
using test::SceneBuilder;

constexpr float pi_f = std::numbers::pi_v<float>;

/// A leaf in the plane y = 0 of base colour 0.5 that sends 0.4 of its light to the other side, in another colour.
int add_leaf(SceneBuilder& b) {
    const int m = b.add_material(glm::vec3(0.5f));
    b.material(m).double_sided = true;
    b.material(m).diffuse_transmission = 0.4f;
    b.material(m).diffuse_transmission_color = {0.2f, 0.6f, 1};
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, m);
    return m;
}

const glm::vec3 leaf_reflects(0.3f), leaf_passes(0.08f, 0.24f, 0.4f);

TEST(DiffuseTransmission, PartsTheLambertPartAmongTheSides) {
    SceneBuilder b;
    add_leaf(b);
    const LitStage stage(b);
    for (const float side : {1.0f, -1.0f}) {
        const SurfacePoint p = stage.point_at(0, 0, {0.3f, 0.3f}, {0, side, 0}).point;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(p.bsdf.diffuse[c], leaf_reflects[c], 1e-6f);
            EXPECT_NEAR(p.bsdf.diffuse_transmission[c], leaf_passes[c], 1e-6f);
        }
        const SurfacePoint other = stage.posed_scene().other_side(p);
        EXPECT_EQ(other.geometric_normal, -p.geometric_normal);
        EXPECT_NE(other.back_side, p.back_side);
    }
}

TEST(DiffuseTransmission, BelowALobeLosesWhatTheLobeTakes) {
    SceneBuilder b;
    const int m = add_leaf(b);
    b.material(m).ior = 1.5f;
    b.material(m).roughness = 0.5f;
    const LitStage stage(b);
    for (const float angle : {0.1f, 0.7f, 1.5f}) {
        const SurfacePoint p = stage.point_at(0, 0, {0.3f, 0.3f}, {std::cos(angle), std::sin(angle), 0}).point;
        const float cosine = glm::dot(p.shading_normal, p.outgoing);
        const glm::vec3 even = diffuse_albedo(p.bsdf, cosine);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(p.bsdf.diffuse_transmission[c] / even[c], leaf_passes[c] / leaf_reflects[c], 1e-4f);
        EXPECT_LT(p.bsdf.diffuse_transmission.z, leaf_passes.z);
        EXPECT_GT(p.bsdf.diffuse_transmission.z, 0.2f * leaf_passes.z);
    }
}

TEST(DiffuseTransmission, UnderAnEvenSkyALeafShowsBothSidesOfIt) {
    SceneBuilder b;
    add_leaf(b);
    b.film().sky.color = glm::vec3(1);
    b.add_camera({0, 3, 2}, {0, 0, 0}, 0.3f);
    Settings settings = test::small_frame(32, 32);
    settings.vpls = 0;
    FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance r = stage.reference();
    int compared = 0;
    for (std::size_t i = 0; i < r.combined.size(); ++i) {
        if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
        ++compared;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(r.combined.values()[i][c] / (leaf_reflects + leaf_passes)[c], 1, 1e-3f) << i;
    }
    EXPECT_GT(compared, 200);
}

/// A sun of irradiance 2 shines from above; the leaf lights the ground below it, 0.01 away, like a lamp.
TEST(DiffuseTransmission, PhotonsLeaveLightOnTheOtherSide) {
    SceneBuilder b;
    add_leaf(b);
    b.add_quad({-0.1f, -0.01f, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, b.add_material(glm::vec3(0)));
    b.material(1).base_color = glm::vec4(0.02f, 0.02f, 0.02f, 1);
    b.add_sun({0, -1, 0}, 2.0f);
    LitStage stage(b);
    const std::vector<LightPoint> lights = stage.direct_points(1, 0);
    const PhotonResult photons = trace_photons(stage.posed_scene(), lights, {1, 4000, 1});
    glm::vec3 above(0), below(0);
    for (std::size_t i = 0; i < photons.vpls.size(); ++i) {
        if (photons.vpls[i].object != 0) continue;
        (photons.vpls[i].normal.y > 0 ? above : below) += photons.vpls[i].intensity;
    }
    // The leaf is 2 x 2: a flux of 8.
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(above[c], 8 * leaf_reflects[c] / pi_f, 0.05f * 8 / pi_f);
        EXPECT_NEAR(below[c] / above[c], leaf_passes[c] / leaf_reflects[c], 1e-3f);
    }
}

Bsdf brushed(float across, float along) {
    Bsdf b;
    b.f0 = glm::vec3(0.6f);
    b.alpha = across;
    b.alpha_along = along;
    b.along = {1, 0, 0};
    return b;
}

/// [KHR_materials_anisotropy, "Implementation"], per steradian, for f0 = f90 = 1; y is across, z the normal.
float anisotropic_formula(float at, float ab, glm::vec3 v, glm::vec3 l) {
    const glm::vec3 h = glm::normalize(v + l), f(h.x * ab, h.y * at, at * ab * h.z);
    const float w2 = at * ab / glm::dot(f, f);
    const float light = v.z * glm::length(glm::vec3(at * l.x, ab * l.y, l.z)),
                view = l.z * glm::length(glm::vec3(at * v.x, ab * v.y, v.z));
    return at * ab * w2 * w2 / pi_f * 0.5f / (light + view);
}

TEST(Anisotropy, ScattersAsItsFormulaSays) {
    const glm::vec3 up{0, 0, 1}, v = glm::normalize(glm::vec3(0.4f, -0.3f, 0.6f));
    Bsdf b = brushed(0.09f, 0.4f);
    b.f0 = b.f90 = glm::vec3(1);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const glm::vec3 l = core::sample_cosine_hemisphere(up, {core::halton(0, i + 1), core::halton(1, i + 1)});
        EXPECT_NEAR(evaluate(b, up, v, l).x / anisotropic_formula(0.4f, 0.09f, v, l), 1, 1e-3f);
    }
}

TEST(Anisotropy, OfEqualWidthsIsTheRoundLobe) {
    const glm::vec3 up{0, 0, 1}, v = glm::normalize(glm::vec3(0.4f, -0.3f, 0.6f));
    Bsdf round = brushed(0.3f, 0.3f);
    round.along = glm::vec3(0);
    for (std::uint64_t i = 0; i < 50; ++i) {
        const glm::vec3 l = core::sample_cosine_hemisphere(up, {core::halton(0, i + 1), core::halton(1, i + 1)});
        EXPECT_NEAR(evaluate(brushed(0.3f, 0.3f), up, v, l).x / evaluate(round, up, v, l).x, 1, 1e-3f);
    }
}

TEST(Anisotropy, SamplesFindWhatItScatters) {
    const glm::vec3 up{0, 0, 1}, v = glm::normalize(glm::vec3(0.5f, 0.2f, 0.5f));
    const Bsdf b = brushed(0.2f, 0.6f);
    glm::dvec3 by_samples(0), by_cosine(0);
    constexpr int n = 40000;
    for (std::uint64_t i = 1; i <= n; ++i) {
        const glm::vec2 u(core::halton(0, i), core::halton(1, i));
        const LobeSample s = sample_glossy(b, up, v, u);
        // Light that is brighter from the left, so that directions count.
        const auto light = [](glm::vec3 d) { return 1.0f + d.x; };
        by_samples += glm::dvec3(s.weight * light(s.direction)) / static_cast<double>(n);
        const glm::vec3 l = core::sample_cosine_hemisphere(up, u);
        by_cosine += glm::dvec3(evaluate(b, up, v, l) * (pi_f * light(l))) / static_cast<double>(n);
    }
    EXPECT_NEAR(by_samples.x / by_cosine.x, 1, 0.01);
}

TEST(Anisotropy, KernelsGatherWhatItScatters) {
    SceneBuilder b;
    const int m = b.add_material(glm::vec3(0.7f));
    b.material(m).metallic = 1;
    b.material(m).roughness = 0.5f;
    b.material(m).anisotropy = 0.7f;
    b.material(m).anisotropy_rotation = 0.3f;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, m);
    b.add_sun({0.5f, -1, 0.2f}, 3.0f);
    LitStage stage(b);
    const LightTrees trees = stage.light({1});
    for (const glm::vec3 eye : {glm::vec3(0, 1, 0), glm::vec3(0.6f, 0.5f, -0.2f), glm::vec3(-0.9f, 0.3f, 0.5f)}) {
        const GatherPoint p = stage.point_at(0, 0, {0.3f, 0.3f}, glm::normalize(eye));
        ASSERT_TRUE(p.point.bsdf.is_stretched());
        EXPECT_NEAR(p.point.bsdf.alpha_along, 0.25f + 0.75f * 0.49f, 1e-5f);
        EXPECT_NEAR(p.point.bsdf.along.x, std::cos(0.3f), 1e-5f);
        // The image's up is towards smaller v, which here is +z.
        EXPECT_NEAR(p.point.bsdf.along.z, std::sin(0.3f), 1e-5f);
        const glm::vec3 l = glm::normalize(glm::vec3(-0.5f, 1, -0.2f));
        const glm::vec3 expected = evaluate(p.point.bsdf, {0, 1, 0}, p.point.outgoing, l) * (3.0f * l.y);
        EXPECT_NEAR(test::gather_all(stage, trees, p).glossy.x / static_cast<double>(expected.x), 1, 1e-3);
    }
}

TEST(Anisotropy, BoundsHold) {
    std::uint64_t counter = 0;
    const auto number = [&] { return core::uniform(5, counter++); };
    for (int i = 0; i < 20000; ++i) {
        const float ab = std::pow(10.0f, -2 * number()), at = ab + (1 - ab) * number();
        const glm::vec3 v = core::sample_cosine_hemisphere({0, 0, 1}, {number(), number()}),
                        l = core::sample_cosine_hemisphere({0, 0, 1}, {number(), number()});
        if (v.z < 1e-3f || l.z < 1e-3f) continue;
        const glm::vec3 mirrored(-v.x, -v.y, v.z);
        const lobe::GlossyBound bound =
            lobe::glossy_bound({l.z, glm::dot(l, mirrored), -glm::dot(l, v)}, v.z, ab * ab, at * at);
        const float value =
            lobe::stretched_value({l.x, l.y, l.z}, {v.x, v.y, v.z}, 2 + 2 * glm::dot(l, v), at * at, ab * ab);
        EXPECT_GE(1.001f * bound.value * at / ab, value) << at << " " << ab;
        EXPECT_GE(1.001f * bound.cosine * at / ab, value * l.z) << at << " " << ab;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
