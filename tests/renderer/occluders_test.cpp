#include "renderer/cut/group_occluders.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/sampling.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// Three rooms in a row with doors between them, a table, and a window to the sky.
SceneBuilder rooms(float scale = 1.0f, glm::vec3 at = glm::vec3(0)) {
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.7f));
    const auto box = [&](glm::vec3 low, glm::vec3 high) { b.add_box(at + scale * low, at + scale * high, grey); };
    box({-0.2f, -0.2f, -0.2f}, {12.2f, 0, 4.2f});
    box({-0.2f, 3, -0.2f}, {12.2f, 3.2f, 4.2f});
    box({-0.2f, 0, -0.2f}, {12.2f, 3, 0});
    box({-0.2f, 0, 4}, {12.2f, 3, 4.2f});
    box({-0.2f, 0, 0}, {0, 3, 1.2f});
    box({-0.2f, 0, 2.8f}, {0, 3, 4});
    box({12, 0, 0}, {12.2f, 3, 4});
    for (const float x : {3.9f, 7.9f}) {
        box({x, 0, 0}, {x + 0.2f, 3, 1.5f});
        box({x, 0, 2.5f}, {x + 0.2f, 3, 4});
    }
    box({1, 0.7f, 1}, {2.5f, 0.75f, 2});
    b.add_point_light(at + scale * glm::vec3(6, 2, 2), scale * scale);
    return b;
}

/// Sixteen neighbouring points of a surface.
void place(const LitStage& stage, std::uint64_t seed, std::vector<GatherPoint>& points, GatherLanes& lanes) {
    const auto& film = stage.posed_scene().animation();
    const auto object = static_cast<std::uint32_t>(core::uniform(seed, 0) * static_cast<float>(film.objects.size()));
    const auto triangles =
        static_cast<float>(film.meshes[static_cast<std::size_t>(film.objects[object].mesh)].triangles.size());
    const auto triangle = static_cast<std::uint32_t>(core::uniform(seed, 1) * triangles);
    const glm::vec2 uv = 0.9f * core::sample_triangle({core::uniform(seed, 2), core::uniform(seed, 3)});
    points.assign(lane_count, {});
    const GatherPoint* pointers[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) {
        const glm::vec2 step(0.02f * static_cast<float>(i % 4), 0.02f * static_cast<float>(i / 4));
        points[i] = stage.point_at(object, triangle, uv + step, stage.posed_scene().front_normal(object, triangle));
        pointers[i] = &points[i];
    }
    fill(lanes, pointers);
}

bool is_blocked(const RayTracer& tracer, glm::vec3 from, glm::vec3 to, bool direction) {
    const glm::vec3 way = direction ? to : to - from;
    const glm::vec3 passed =
        tracer.passes(from, way, direction ? std::numeric_limits<float>::infinity() : 1.0f - 0x1p-18f);
    return passed == glm::vec3(0);
}

class Occluders : public testing::TestWithParam<std::pair<float, float>> {};

TEST_P(Occluders, HideOnlyWhatNoRayReaches) {
    const auto [scale, distance] = GetParam();
    const glm::vec3 at(distance * scale, 0.2f * distance * scale, 0);
    LitStage stage(rooms(scale, at));
    const RayTracer& tracer = stage.posed_scene().tracer();
    ASSERT_GT(tracer.occluders().size(), 10u);
    std::vector<GatherPoint> points;
    GatherLanes lanes;
    GroupOccluders occluders;
    int hidden = 0, asked = 0, reached = 0;
    for (std::uint64_t g = 0; g < 300; ++g) {
        place(stage, 100 + g, points, lanes);
        occluders.choose(lanes, tracer.occluders());
        for (std::uint64_t n = 0; n < 30; ++n) {
            // Boxes of all sizes in and about the rooms, and of directions.
            const auto u = [&](std::uint64_t k) { return core::uniform(7, 30 * g + n, k); };
            const bool far_away = n % 3 == 0;
            const glm::vec3 middle = far_away ? core::sample_sphere({u(0), u(1)})
                                              : at + scale * glm::vec3(14 * u(0) - 1, 5 * u(1) - 1, 6 * u(2) - 1);
            const glm::vec3 half = (far_away ? 0.3f : scale) * u(3) * u(3) * glm::vec3(u(4), u(5), u(6));
            const LightType type = far_away ? LightType::directional : LightType::oriented;
            std::uint16_t viable = GroupOccluders::all;
            ++asked;
            const bool hides = occluders.hide(lanes, type, middle, half, viable);
            // What hides a box is viable for it, and what is not viable hides no part of it.
            ASSERT_TRUE(!hides || viable != 0);
            for (std::uint64_t k = 0; k < 4; ++k) {
                const glm::vec3 part =
                    middle + half * (2.0f * glm::vec3(core::uniform(8, n, 3 * k), core::uniform(9, n, k),
                                                      core::uniform(10, g, k)) -
                                     1.0f);
                const auto lane = static_cast<int>(core::uniform(11, g + n, k) * lane_count);
                const glm::vec3 from{lanes.origin.x[lane], lanes.origin.y[lane], lanes.origin.z[lane]};
                ASSERT_TRUE(!hides || is_blocked(tracer, from, part, far_away)) << g << " " << n;
                reached += is_blocked(tracer, from, part, far_away) ? 0 : 1;
                std::uint16_t other = static_cast<std::uint16_t>(GroupOccluders::all & ~viable);
                ASSERT_FALSE(other != 0 && occluders.hide(lanes, type, part, glm::vec3(0), other));
            }
            hidden += hides ? 1 : 0;
        }
    }
    // Most of what is behind walls is found to be.
    EXPECT_GT(hidden, asked / 5);
    EXPECT_GT(reached, asked / 4);
}
INSTANTIATE_TEST_SUITE_P(ScalesAndDistances, Occluders,
                         testing::Values(std::pair{1.0f, 0.0f}, std::pair{1e-3f, 0.0f}, std::pair{1e5f, 0.0f},
                                         std::pair{1.0f, 300.0f}));

TEST(OccludersOf, PairTrianglesToConvexQuadsAndKeepTheLargest) {
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.5f));
    b.add_box({0, 0, 0}, {4, 3, 2}, grey);
    b.add_sphere({9, 1, 1}, 0.2f, grey, 12);
    LitStage stage(b);
    const OccluderList& occluders = stage.posed_scene().tracer().occluders();
    ASSERT_GT(occluders.size(), 6u);
    double area = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        const Occluder& s = occluders[i];
        EXPECT_NE(s.corner[2], s.corner[3]);
        area += 0.5 * glm::length(glm::cross(s.corner[2] - s.corner[0], s.corner[3] - s.corner[1]));
    }
    EXPECT_NEAR(area, 52.0, 1e-3);
}

TEST(OccludersOf, LeaveOutWhatMovesOrLetsLightThrough) {
    SceneBuilder b;
    const int glass = b.add_material(glm::vec3(1));
    b.material(glass).transmission = 1;
    b.add_quad({0, 0, 0}, {0, 0, 9}, {9, 0, 0}, glass);
    const int moving = b.add_quad({0, 5, 0}, {0, 0, 9}, {9, 0, 0}, b.add_material(glm::vec3(0.5f)));
    b.move_object(moving, {{0, 0, 0}, {1, 0, 0}});
    LitStage stage(b);
    EXPECT_EQ(stage.posed_scene().tracer().occluders().size(), 0u);
}

TEST(OccluderedCuts, LoseNoLightButSaveRays) {
    // The far room is lit through two doors; its cut does not ask about what lies behind walls.
    LitStage stage(rooms());
    std::vector<LightPoint> sky;
    for (std::uint32_t i = 0; i < 512; ++i) {
        LightPoint p;
        p.kind = LightPointKind::directional;
        p.normal = -core::sample_sphere({core::uniform(1, i, 0), core::uniform(1, i, 1)});
        p.intensity = glm::vec3(0.01f);
        p.id = i;
        sky.push_back(p);
    }
    LightTrees light_trees = build_light_trees(sky, {}, 1);
    std::vector<GatherPoint> points;
    GatherLanes lanes;
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    std::uint64_t rays = 0, all_rays = 0;
    for (std::uint64_t g = 0; g < 60; ++g) {
        place(stage, 500 + g, points, lanes);
        if (g % 2 == 0) {
            // Every second group shines.
            const GatherPoint* pointers[lane_count];
            for (std::size_t i = 0; i < lane_count; ++i) {
                points[i].point.bsdf.f0 = glm::vec3(0.04f);
                points[i].point.bsdf.alpha = 0.4f;
                pointers[i] = &points[i];
            }
            fill(lanes, pointers);
        }
        GroupTolerance tolerance{};
        std::fill(std::begin(tolerance.absolute), std::end(tolerance.absolute), 1e-9f);
        GatheredLight light, all;
        gatherer.gather(lanes, tolerance, {8, 1 << 20}, light);
        gatherer.gather_all(lanes, all);
        for (int i = 0; i < lane_count; ++i)
            ASSERT_NEAR(light.direct.r[i], all.direct.r[i], 1e-5f * all.direct.r[i] + 1e-8f);
        for (int i = 0; i < lane_count && lanes.glossy; ++i) {
            ASSERT_NEAR(light.f0.r[i], all.f0.r[i], 1e-5f * all.f0.r[i] + 1e-8f);
            ASSERT_NEAR(light.schlick.r[i], all.schlick.r[i], 1e-5f * all.schlick.r[i] + 1e-8f);
        }
        rays += light.shadow_rays;
        all_rays += all.shadow_rays;
    }
    EXPECT_LT(rays, all_rays / 2);
    EXPECT_GT(rays, all_rays / 50);
}

}  // namespace
}  // namespace render2mpeg::renderer
