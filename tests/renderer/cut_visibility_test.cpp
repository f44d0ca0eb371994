#include <gtest/gtest.h>

#include <cmath>

#include "core/sampling.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// A box seen from inside, its corners where they are in space: nothing in it can shadow anything, whatever rays meet
/// at their ends. One of the boxes below has a wall in a plane through the origin, where surface points have hardly any
/// offset.
SceneBuilder hollow(float scale, glm::vec3 at) {
    SceneBuilder b;
    b.add_box(at - scale * glm::vec3(1, 0.7f, 1.2f), at + scale * glm::vec3(0.9f, 1, 1),
              b.add_material(glm::vec3(0.8f)), true);
    b.add_point_light(at + glm::vec3(0.1f, 0.2f, -0.1f) * scale, scale * scale);
    return b;
}

class ShadowRays : public testing::TestWithParam<std::pair<float, float>> {};

TEST_P(ShadowRays, MeetNothingBetweenPointsOfAConvexRoom) {
    const auto [scale, distance] = GetParam();
    LitStage stage(hollow(scale, glm::vec3(distance * scale, 0.3f * distance * scale, 0)));
    const LightTrees light_trees = stage.light({16, 400, 4, 0, GeometryClamp::none()});
    const LightTree& tree = light_trees.trees[LightTrees::direct_trees];
    ASSERT_GT(tree.lights.size(), 300u);
    const auto triangles = static_cast<std::uint32_t>(stage.posed_scene().animation().meshes[0].triangles.size());
    std::vector<GatherPoint> points(lane_count);
    const GatherPoint* pointers[lane_count];
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    double lit = 0, expected = 0;
    for (std::uint64_t g = 0; g < 20; ++g) {
        for (std::uint64_t i = 0; i < lane_count; ++i) {
            const auto triangle = static_cast<std::uint32_t>(core::uniform(3, g, i) * static_cast<float>(triangles));
            const glm::vec2 uv = core::sample_triangle({core::uniform(4, g, i), core::uniform(5, g, i)});
            points[i] = stage.point_at(0, triangle, uv, stage.posed_scene().front_normal(0, triangle));
            pointers[i] = &points[i];
        }
        GatherLanes lanes;
        fill(lanes, pointers);
        GatheredLight light;
        gatherer.gather_all(lanes, light);
        for (int i = 0; i < lane_count; ++i) lit += light.indirect.r[i];
        for (const TreeLight& l : tree.lights) {
            LightLanes unit;
            evaluate_light(lanes, tree.type, l, nullptr, light_trees.point_clamp, unit);
            for (int i = 0; i < lane_count; ++i) expected += static_cast<double>(unit.diffuse[i]) * l.intensity.x;
        }
    }
    EXPECT_NEAR(lit / expected, 1.0, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(ScalesAndDistances, ShadowRays,
                         testing::Values(std::pair{1.0f, 0.0f}, std::pair{1e-4f, 0.0f}, std::pair{1e6f, 0.0f},
                                         std::pair{278.0f, 1.0f}, std::pair{1.0f, 100.0f}, std::pair{1e-3f, 100.0f}));

/// Leaves values that are no numbers where the next call keeps its own.
__attribute__((noinline)) void poison_stack() {
    volatile unsigned char junk[1 << 15];
    for (volatile unsigned char& byte : junk) byte = 0xff;
}

TEST(GatherAll, OfLanesThatNoLightIsAimedAtIsANumberUnderGlass) {
    // Lanes on the outside of a room under a pane: no light of it is on their side.
    SceneBuilder b;
    b.add_box({0, 0, 0}, {2, 2, 2}, b.add_material(glm::vec3(0.8f)), true);
    const int glass = b.add_material(glm::vec3(1));
    b.material(glass).transmission = 1;
    b.add_quad({0.5f, 1.9f, 0.5f}, {0, 0, 1}, {1, 0, 0}, glass);
    b.add_point_light({1, 1, 1}, 5);
    LitStage stage(b);
    const LightTrees light_trees = stage.light({16, 200, 4, 0, GeometryClamp{}});
    ASSERT_TRUE(light_trees.translucent);
    GatherPoint points[2] = {stage.point_at(0, 0, {0.3f, 0.3f}, stage.posed_scene().front_normal(0, 0)),
                             stage.point_at(0, 0, {0.3f, 0.3f}, -stage.posed_scene().front_normal(0, 0))};
    const GatherPoint* const pointers[] = {&points[0], &points[1]};
    GatherLanes lanes;
    fill(lanes, pointers);
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    GatheredLight light;
    poison_stack();
    gatherer.gather_all(lanes, light);
    EXPECT_GT(light.indirect.at(0).x, 0.0f);
    for (int i = 0; i < lane_count; ++i) EXPECT_TRUE(std::isfinite(light.indirect.at(i).x)) << i;
}

}  // namespace
}  // namespace render2mpeg::renderer
