// Where smooth bodies of triangles go dark.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;

const glm::vec3 to_sun = glm::normalize(glm::vec3(-1, 0.3f, 0.1f));

/// A dull white ball of few triangles, stretched, under a sun from the side.
SceneBuilder ball(glm::dvec3 scaled) {
    SceneBuilder b;
    b.add_object(b.add_mesh(SceneBuilder::sphere(1, 12)), b.add_material({1, 1, 1}), {0, 0, 0}, {1, 0, 0, 0}, scaled);
    b.add_sun(-to_sun, std::numbers::pi_v<float>);
    b.add_camera({0, 0, 8}, {0, 0, 0}, 0.3f);
    return b;
}

class Terminator : public testing::TestWithParam<glm::dvec3> {};

TEST_P(Terminator, OfASmoothBallLiesWhereItsShadingEnds) {
    const SceneBuilder b = ball(GetParam());
    Settings settings = test::small_frame(64, 64);
    settings.samples = 1;
    settings.vpls = 0;
    test::FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    int lit = 0, off = 0;
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
        const float expected = std::max(0.0f, glm::dot(seen.visible.shading_normal.values()[i].unpack(), to_sun));
        lit += expected > 0.0f ? 1 : 0;
        off += std::abs(frame.combined.values()[i].x - expected) > 0.01f ? 1 : 0;
    }
    EXPECT_GT(lit, 400);
    EXPECT_EQ(off, 0);
}
INSTANTIATE_TEST_SUITE_P(Balls, Terminator,
                         testing::Values(glm::dvec3(1, 1, 1), glm::dvec3(0.6, 1, 1), glm::dvec3(1, 1, -0.5)));

TEST(SmoothSurface, OfABallIsTheBall) {
    // Of a triangle's corners, edges and middle: at the corners nothing is lifted, elsewhere nearly to the ball.
    const test::Stage stage(ball({1, 1, 1}));
    for (std::uint32_t triangle = 100; triangle < 400; triangle += 37) {
        const glm::vec3 front = stage.posed_scene().front_normal(0, triangle);
        for (const glm::vec2 uv : {glm::vec2(0.33f, 0.33f), glm::vec2(0.5f, 0.0f), glm::vec2(0.2f, 0.6f)}) {
            const SurfacePoint p = stage.posed_scene().surface_at({0, triangle, uv.x, uv.y}, front);
            const float depth = 1.0f - glm::length(p.position);
            EXPECT_GT(depth, 1e-3f);
            EXPECT_NEAR(glm::length(p.position + p.smooth.lift), 1.0f, 0.1f * depth);
            EXPECT_LT(glm::distance(p.geometric_normal + p.smooth.tilt, glm::normalize(p.position)), 0.02f);
            // From inside it is hollow.
            const SurfacePoint inside = stage.posed_scene().surface_at({0, triangle, uv.x, uv.y}, -front);
            EXPECT_EQ(inside.smooth.lift, glm::vec3(0));
        }
        const SurfacePoint corner = stage.posed_scene().surface_at({0, triangle, 1.0f, 0.0f}, front);
        EXPECT_LT(glm::length(corner.smooth.lift), 1e-4f);
    }
}

TEST(SmoothSurface, IsNoneWhereNormalsMakeNoSense) {
    // A box with the normals of a ball, and a flat one.
    for (const bool round : {true, false}) {
        SceneBuilder b;
        scene::Mesh mesh = SceneBuilder::box({-1, -1, -1}, {1, 1, 1}, false);
        if (round)
            for (std::size_t i = 0; i < mesh.positions.size(); ++i)
                mesh.normals.push_back(glm::normalize(mesh.positions[i]));
        b.add_object(b.add_mesh(mesh), b.add_material());
        const test::Stage stage(b);
        for (std::uint32_t triangle = 0; triangle < 12; ++triangle) {
            const glm::vec3 front = stage.posed_scene().front_normal(0, triangle);
            const SurfacePoint p = stage.posed_scene().surface_at({0, triangle, 0.4f, 0.2f}, front);
            EXPECT_EQ(p.smooth.lift, glm::vec3(0));
            EXPECT_EQ(p.smooth.tilt, glm::vec3(0));
        }
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
