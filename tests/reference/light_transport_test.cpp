#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/reference/path_tracer.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::gather_all;
using test::LightingSettings;
using test::LitStage;
using test::Scattered;
using test::SceneBuilder;

/// The mean over independent sets of light points and VPLs of what the reference (every light point, no clamp) scatters
/// at a point.
reference::Estimate mean_of_sets(LitStage& stage, const GatherPoint& point, LightingSettings settings, int sets) {
    glm::dvec3 sum(0), squares(0);
    for (int s = 0; s < sets; ++s) {
        settings.set = static_cast<std::uint64_t>(s);
        const glm::dvec3 l = gather_all(stage, stage.light(settings), point).all();
        sum += l;
        squares += l * l;
    }
    reference::Estimate e;
    e.mean = sum / static_cast<double>(sets);
    for (int k = 0; k < 3; ++k)
        e.error[k] = std::sqrt(std::max(0.0, squares[k] / sets - e.mean[k] * e.mean[k]) / (sets - 1));
    return e;
}

/// Both estimates agree within four standard errors, and are known well enough for that to mean something.
void expect_same(const reference::Estimate& points, const reference::Estimate& paths, double known_to) {
    for (int k = 0; k < 3; ++k) {
        const double error = std::hypot(points.error[k], paths.error[k]);
        EXPECT_LT(std::abs(points.mean[k] - paths.mean[k]), 4 * error + 1e-5 * paths.mean[k])
            << "channel " << k << ": light points " << points.mean[k] << " +- " << points.error[k] << ", paths "
            << paths.mean[k] << " +- " << paths.error[k];
        EXPECT_LT(error, known_to * paths.mean[k]);
    }
}

/// A room of grey, red and green walls with a panel below its ceiling, and a block that casts a shadow.
SceneBuilder room(bool panel) {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f}), red = b.add_material({0.6f, 0.1f, 0.1f});
    b.add_quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, grey);    // 0: floor
    b.add_quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, grey);     // 1: ceiling
    b.add_quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, grey);     // 2: back
    b.add_quad({0, 0, 4}, {0, 0, -4}, {0, 3, 0}, red);     // 3: left
    b.add_quad({4, 0, 0}, {0, 0, 4}, {0, 3, 0}, grey);     // 4: right
    b.add_quad({4, 0, 4}, {-4, 0, 0}, {0, 3, 0}, grey);    // 5: front
    b.add_box({2.6f, 0, 0.6f}, {3.4f, 1.0f, 1.4f}, grey);  // 6
    if (panel)
        b.add_quad({1, 2.5f, 1}, {1.5f, 0, 0}, {0, 0, 1.5f}, b.add_emitter({10, 8, 6}));  // 7
    else
        b.add_point_light({1.5f, 2.0f, 2.5f}, 5.0f, {1, 0.8f, 0.6f});
    return b;
}

/// Points in the middle of walls, and one that the block half shadows: away from other surfaces, where the sum over
/// VPLs has a variance.
const struct {
    std::uint32_t object;
    glm::vec2 uv;
} patches[] = {{0, {0.25f, 0.25f}}, {2, {0.3f, 0.3f}}, {3, {0.25f, 0.3f}}, {4, {0.3f, 0.25f}}};

/// One of them, seen from the room's middle.
GatherPoint patch_point(const LitStage& stage, int index) {
    const auto& patch = patches[index];
    const glm::vec3 position = stage.point_at(patch.object, 0, patch.uv, {0, 1, 0}).point.position;
    return stage.point_at(patch.object, 0, patch.uv, glm::vec3(2, 1.5f, 2) - position);
}

class LightTransportSlow : public testing::TestWithParam<int> {};

TEST_P(LightTransportSlow, OfAnAreaLightIsTheRenderingEquations) {
    LitStage stage(room(true));
    const GatherPoint point = patch_point(stage, GetParam());
    const auto points = mean_of_sets(stage, point, {512, 0, 0}, 24);
    expect_same(points, reference::scattered_light(stage.posed_scene(), point.point, 0, 200000, 1), 0.02);
}

TEST_P(LightTransportSlow, OfOneBounceIsTheRenderingEquations) {
    LitStage stage(room(true));
    const GatherPoint point = patch_point(stage, GetParam());
    const auto points = mean_of_sets(stage, point, {256, 2000, 1}, 24);
    expect_same(points, reference::scattered_light(stage.posed_scene(), point.point, 1, 300000, 2), 0.02);
}

TEST_P(LightTransportSlow, OfSixBouncesIsTheRenderingEquations) {
    LitStage stage(room(false));
    const GatherPoint point = patch_point(stage, GetParam());
    const auto points = mean_of_sets(stage, point, {16, 1500, 6}, 24);
    expect_same(points, reference::scattered_light(stage.posed_scene(), point.point, 6, 60000, 3), 0.02);
}
INSTANTIATE_TEST_SUITE_P(Patches, LightTransportSlow, testing::Range(0, 4));

TEST(LightTransportSlow, OfSkyAndSunWithABounceIsTheRenderingEquations) {
    SceneBuilder b = room(false);
    b.film().objects.erase(b.film().objects.begin() + 1);  // no ceiling
    b.film().lights.clear();
    b.add_sun({0.3f, -1, -0.2f}, 3.0f);
    b.film().sky.color = {0.5f, 0.7f, 1.0f};
    LitStage stage(b);
    const GatherPoint point = stage.point_at(1, 0, {0.3f, 0.3f}, glm::vec3(2, 1.5f, 2));
    const auto points = mean_of_sets(stage, point, {2000, 3000, 2}, 16);
    const auto paths = reference::scattered_light(stage.posed_scene(), point.point, 2, 200000, 4);
    // The sky's directions are the same in every set: their own error is not in the spread, and below 1 % here.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(points.mean[k] / paths.mean[k], 1.0, 0.02) << k;
}

TEST(LightTransportSlow, OfAGlossyFloorUnderAPanelIsTheRenderingEquations) {
    SceneBuilder b = room(true);
    b.material(0).ior = 1.5f;
    b.material(0).roughness = 0.6f;
    LitStage stage(b);
    const GatherPoint point = stage.point_at(0, 0, {0.25f, 0.25f}, glm::vec3(1.5f, 1.0f, -3.0f));
    ASSERT_TRUE(point.point.bsdf.has_glossy());
    const auto points = mean_of_sets(stage, point, {1024, 0, 0}, 24);
    expect_same(points, reference::scattered_light(stage.posed_scene(), point.point, 0, 400000, 5), 0.02);
}

/// A floor of rough dielectric or metal, seen at a low angle under a sun, a lamp, a sky, and in light that two such
/// walls scatter.
class RoughFloorSlow : public testing::TestWithParam<float> {};

TEST_P(RoughFloorSlow, UnderSunLampSkyAndBouncesIsTheRenderingEquations) {
    SceneBuilder b = room(false);
    b.film().objects.erase(b.film().objects.begin() + 1);  // no ceiling
    for (scene::Material& m : b.film().materials) {
        m.ior = 1.5f;
        m.metallic = GetParam();
        m.roughness = 0.8f;
    }
    b.add_sun({0.3f, -1, -0.2f}, 1.0f);
    b.film().sky.color = {0.5f, 0.7f, 1.0f};
    LitStage stage(b);
    const GatherPoint point = stage.point_at(0, 0, {0.25f, 0.25f}, glm::vec3(1.5f, 0.4f, -3.0f));
    const auto points = mean_of_sets(stage, point, {2000, 3000, 2}, 16);
    const auto paths = reference::scattered_light(stage.posed_scene(), point.point, 2, 200000, 6);
    // Walls scatter as if they were dull (photons.cpp), which is off by more where they are metal.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(points.mean[k] / paths.mean[k], 1.0, GetParam() > 0 ? 0.05 : 0.02) << k;
}
INSTANTIATE_TEST_SUITE_P(Metals, RoughFloorSlow, testing::Values(0.0f, 1.0f));

/// A closed room whose walls all emit 1 and reflect r: everything is 1 + r + r^2 + ... bright, seen or gathered
/// anywhere.
TEST(FurnaceSlow, IsAsBrightAsTheGeometricSeries) {
    for (const float r : {0.2f, 0.5f}) {
        SceneBuilder b;
        const int wall = b.add_material(glm::vec3(r));
        b.material(wall).emission = glm::vec3(1);
        b.add_box({0, 0, 0}, {2, 2, 2}, wall, true);
        LitStage stage(b);
        const int bounces = 5;
        double expected = 0;
        for (int k = 1; k <= bounces + 1; ++k) expected += std::pow(r, k);
        for (const std::uint32_t triangle : {0u, 5u, 8u}) {
            const GatherPoint point =
                stage.point_at(0, triangle, {0.4f, 0.2f}, stage.posed_scene().front_normal(0, triangle));
            const auto sum = mean_of_sets(stage, point, {512, 1000, bounces}, 24);
            EXPECT_LT(std::abs(sum.mean.x - expected), 4 * sum.error.x + 1e-4)
                << r << " " << sum.mean.x << " +- " << sum.error.x << " for " << expected;
            EXPECT_LT(sum.error.x, 0.02 * expected);
        }
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
