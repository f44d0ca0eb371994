#include "renderer/view/normal_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/color.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr float alpha = 0.01f;
constexpr int balls_across = 5;

SurfacePoint polished_point() {
    SurfacePoint p;
    p.geometric_normal = p.shading_normal = {0, 0, 1};
    p.outgoing = glm::normalize(glm::vec3(0.3f, 0, 1));
    p.bsdf.f0 = glm::vec3(1);
    p.bsdf.alpha = alpha;
    return p;
}

/// A normal turned from z towards (x, y).
glm::vec3 turned(float x, float y) {
    return glm::normalize(glm::vec3(x, y, 1));
}

TEST(NormalSpread, WidensTheLobeAcrossABentEdgeByTheVarianceOfSlopes) {
    constexpr float half = 0.15f;
    constexpr int count = 64;
    for (const float angle : {0.0f, 0.6f, 1.2f, 2.0f}) {
        const glm::vec2 across(std::cos(angle), std::sin(angle));
        NormalSpread spread;
        for (int i = 0; i < count; ++i) {
            const float s = half * ((2.0f * static_cast<float>(i) + 1.0f) / count - 1.0f);
            spread.add(turned(s * across.x, s * across.y), {}, 0.5f);
        }
        SurfacePoint p = polished_point();
        spread.fold_into(p);
        ASSERT_TRUE(p.bsdf.is_stretched());
        // Evenly spread slopes vary by half^2 / 3.
        EXPECT_NEAR(p.bsdf.alpha_along, std::sqrt(alpha * alpha + 2.0f * half * half / 3.0f), 0.002f);
        EXPECT_NEAR(p.bsdf.alpha, alpha, 0.001f);
        EXPECT_NEAR(std::abs(glm::dot(p.bsdf.along, glm::vec3(across, 0))), 1.0f, 1e-3f);
        EXPECT_NEAR(p.shading_normal.z, 1.0f, 1e-5f);
    }
}

TEST(NormalSpread, OfOneSampleIsThatOfItsFootprint) {
    constexpr float turn = 0.1f;
    NormalSpread spread;
    spread.add({0, 0, 1}, {{turn, 0, 0}, {0, turn, 0}}, 1);
    SurfacePoint p = polished_point();
    spread.fold_into(p);
    EXPECT_FALSE(p.bsdf.is_stretched());
    EXPECT_NEAR(p.bsdf.alpha, std::sqrt(alpha * alpha + turn * turn / 6.0f), 1e-4f);
}

TEST(NormalSpread, LeavesFlatAndWideLobesAlone) {
    NormalSpread flat, bent;
    for (int i = 0; i < 16; ++i) {
        flat.add(glm::normalize(glm::vec3(0.2f, 0.1f, 1)), {}, 1);
        bent.add(turned(0.01f * static_cast<float>(i % 4), 0), {}, 1);
    }
    SurfacePoint p = polished_point();
    flat.fold_into(p);
    EXPECT_EQ(p.bsdf.alpha, alpha);
    EXPECT_FALSE(p.bsdf.is_stretched());
    p.bsdf.alpha = 0.2f;
    bent.fold_into(p);
    EXPECT_EQ(p.bsdf.alpha, 0.2f);
    EXPECT_FALSE(p.bsdf.is_stretched());
}

TEST(NormalSpread, WidensAStretchedLobeAlongItsOwnAxes) {
    NormalSpread spread;
    for (const float s : {-0.07f, 0.07f}) spread.add(turned(0, s), {}, 1);
    SurfacePoint p = polished_point();
    p.bsdf.along = {1, 0, 0};
    p.bsdf.alpha_along = 0.5f;
    spread.fold_into(p);
    ASSERT_TRUE(p.bsdf.is_stretched());
    EXPECT_NEAR(std::abs(p.bsdf.along.x), 1.0f, 1e-3f);
    EXPECT_NEAR(p.bsdf.alpha_along, 0.5f, 1e-3f);
    EXPECT_NEAR(p.bsdf.alpha, std::sqrt(alpha * alpha + 2.0f * 0.0049f), 2e-3f);
}

TEST(NormalSpread, KeepsTheFirstNormalWhereTheMeanFacesAway) {
    NormalSpread spread;
    for (const float s : {0.0f, 8.0f, 9.0f}) spread.add(glm::normalize(glm::vec3(s, 0, 1 - s)), {}, 1);
    SurfacePoint p = polished_point();
    spread.fold_into(p);
    EXPECT_EQ(p.shading_normal, glm::vec3(0, 0, 1));
    NormalSpread().fold_into(p);
    EXPECT_EQ(p.bsdf.alpha, alpha);
}

/// Metal balls in the sun, each at another place of its pixels.
SceneBuilder metal_balls(float radius, float irradiance, float eye_far, float field) {
    SceneBuilder b;
    const int metal = b.add_material({1, 1, 1});
    b.material(metal).metallic = 1;
    b.material(metal).roughness = 0.12f;
    const int ball = b.add_mesh(SceneBuilder::sphere(radius, 32));
    const float spacing = 2.0f * eye_far * std::tan(0.5f * field) / balls_across;
    for (int i = 0; i < balls_across * balls_across; ++i) {
        const auto x = static_cast<float>(i % balls_across), y = static_cast<float>(i / balls_across);
        b.add_object(ball, metal, {spacing * (x - 2.0f + 0.031f * y), spacing * (y - 2.0f + 0.027f * x), 0});
    }
    b.add_sun({0, -1, -1}, irradiance);
    b.add_camera({0, 0, eye_far}, {0, 0, 0}, field);
    return b;
}

// A ball that reflects all scatters a far lamp's light evenly: its intensity is E r^2 / 4. Its highlight is a tenth of
// a pixel wide; samples that met it or missed it made this deviate by 7.
TEST(NormalSpread, MetalBallsSendAllAlikeWhatTheyReflect) {
    constexpr int size = 12 * balls_across;
    constexpr float irradiance = 2, eye_far = 40, field = 0.1f;
    for (const float radius : {0.1f, 0.2f}) {
        Settings settings = test::small_frame(size, size);
        settings.vpls = 0;
        settings.samples = 16;
        FilmStage stage(metal_balls(radius, irradiance, eye_far, field), settings);
        const core::Radiance frame = stage.reference();
        const float pixel = 2.0f * std::tan(0.5f * field) / size;
        const float expected = irradiance * radius * radius / (4.0f * eye_far * eye_far * pixel * pixel);
        std::vector<double> shares(balls_across * balls_across, 0.0);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                shares[static_cast<std::size_t>(y / 12 * balls_across + x / 12)] +=
                    static_cast<double>(core::luminance(frame.combined.at(x, y)) / expected);
        double sum = 0, squares = 0;
        for (const double share : shares) {
            sum += share;
            squares += share * share;
        }
        const auto count = static_cast<double>(shares.size());
        const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
        EXPECT_NEAR(mean, 1.0, 0.3) << radius;
        EXPECT_LT(deviation, 1.2) << radius;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
