#include "renderer/cut/reference_gather.h"

#include <gtest/gtest.h>

#include "core/sampling.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// A room with a lamp of every type, a screen, and a pane of tinted glass.
SceneBuilder hall(bool glass, int lamps) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {3, 2, 3}, b.add_material(glm::vec3(0.8f, 0.6f, 0.5f)), true);
    b.add_quad({1.5f, 0.2f, 1}, {0, 1.2f, 0}, {0, 0, 1}, b.add_material(glm::vec3(0.5f)));
    b.add_quad({0.5f, 1.9f, 0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter({3, 4, 5}));
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(lamps); ++i)
        b.add_point_light({0.2f + 2.6f * core::uniform(1, i, 0), 1.5f, 0.2f + 2.6f * core::uniform(1, i, 1)}, 1);
    if (!glass) return b;
    const int pane = b.add_material({0.9f, 0.5f, 0.2f});
    b.material(pane).transmission = 1;
    b.add_quad({0.4f, 1.7f, 0.4f}, {0, 0, 1.5f}, {1.5f, 0, 0}, pane);
    return b;
}

/// A few lamps are gathered exactly, many are a tree.
class LonePoints : public testing::TestWithParam<std::tuple<bool, bool, int>> {};

TEST_P(LonePoints, ReceiveWhatTheyReceiveInACrowd) {
    const auto [glossy, glass, lamps] = GetParam();
    LitStage stage(hall(glass, lamps));
    const LightTrees light_trees = stage.light({64, 300, 3, 0, GeometryClamp{0.25f}});
    ASSERT_EQ(light_trees.exact.empty(), lamps > 16);
    std::vector<GatherPoint> points(lane_count);
    const GatherPoint* pointers[lane_count];
    for (std::uint64_t i = 0; i < lane_count; ++i) {
        const auto triangle = static_cast<std::uint32_t>(12.0f * core::uniform(3, i, 0));
        points[i] = stage.point_at(0, triangle, core::sample_triangle({core::uniform(3, i, 1), core::uniform(3, i, 2)}),
                                   stage.posed_scene().front_normal(0, triangle));
        if (glossy) {
            points[i].point.bsdf.f0 = glm::vec3(0.04f);
            points[i].point.bsdf.alpha = 0.2f;
        }
        pointers[i] = &points[i];
    }
    GatherLanes lanes;
    fill(lanes, pointers);
    GatheredLight all;
    Gatherer(light_trees, stage.posed_scene().tracer()).gather_all(lanes, all);
    double light = 0;
    for (int i = 0; i < lane_count; ++i) {
        GatheredLight alone;
        gather_all(light_trees, stage.posed_scene().tracer(), points[static_cast<std::size_t>(i)], alone);
        const auto expect = [&](glm::vec3 found, glm::vec3 expected, const char* what) {
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 3e-6f * (expected[c] + 1.0f)) << what << i;
            light += expected.x;
        };
        expect(alone.direct.at(0), all.direct.at(i), "direct ");
        expect(alone.indirect.at(0), all.indirect.at(i), "indirect ");
        if (!glossy) continue;
        expect(alone.f0.at(0), all.f0.at(i), "f0 ");
        expect(alone.schlick.at(0), all.schlick.at(i), "schlick ");
    }
    EXPECT_GT(light, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LonePoints,
                         testing::Combine(testing::Bool(), testing::Bool(), testing::Values(2, 40)));

}  // namespace
}  // namespace render2mpeg::renderer
