#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/sampling.h"
#include "renderer/geometry/ray_tracer.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using renderer::Hit;

constexpr float endless = std::numeric_limits<float>::infinity();

/// A still floor, a box that travels and turns, two instanced crowds of still spheres, and a sheet that morphs into a
/// hill.
SceneBuilder everything_that_moves() {
    SceneBuilder builder;
    const int white = builder.add_material();
    builder.add_quad({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}, white);
    const int box = builder.add_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, white);
    builder.move_object(box, {{-3, 1, 0}, {-1, 2, 1}, {4, 1, -2}});
    const int node = builder.film().objects[static_cast<std::size_t>(box)].node;
    builder.add_track(scene::TrackTarget::rotation, node, 4, {0, 2}, {0, 0, 0, 1, 0, 0.70710678f, 0, 0.70710678f});

    // More triangles in copies than are worth copying.
    const int ball = builder.add_mesh(SceneBuilder::sphere(0.3f, 64));
    for (int i = 0; i < 6; ++i) builder.add_object(ball, white, {2.0 * i - 5.0, 3.0, -4.0}, {1, 0, 0, 0}, {1, 2, 1});

    scene::Mesh sheet;
    for (int y = 0; y <= 8; ++y)
        for (int x = 0; x <= 8; ++x)
            sheet.positions.push_back({0.5f * static_cast<float>(x), 0, 0.5f * static_cast<float>(-y)});
    for (std::uint32_t y = 0; y < 8; ++y) {
        for (std::uint32_t x = 0; x < 8; ++x) {
            const std::uint32_t i = 9 * y + x;
            sheet.triangles.push_back({i, i + 1, i + 10});
            sheet.triangles.push_back({i, i + 10, i + 9});
        }
    }
    scene::MorphTarget hill;
    for (const glm::vec3& p : sheet.positions) hill.positions.push_back({0, 0.4f * p.x - 0.1f * p.z * p.z, 0});
    sheet.morph_targets.push_back(hill);
    const int object = builder.add_object(builder.add_mesh(sheet), white, {-2, 4, 5});
    builder.film().objects[static_cast<std::size_t>(object)].morph_weights = {0};
    builder.add_track(scene::TrackTarget::weights, builder.film().objects[static_cast<std::size_t>(object)].node, 1,
                      {0, 2}, {0, 1});
    return builder;
}

struct Traced {
    std::vector<Hit> hits;
    std::vector<glm::vec3> points;
};

Traced trace_all(const Stage& stage) {
    Traced traced;
    for (std::uint64_t i = 1; i <= 4000; ++i) {
        const glm::vec3 from{16 * core::halton(0, i) - 8, 9, 16 * core::halton(1, i) - 8};
        const glm::vec3 to{12 * core::halton(2, i) - 6, 0, 12 * core::halton(3, i) - 6};
        const glm::vec3 direction = glm::normalize(to - from);
        traced.hits.push_back(stage.tracer().nearest(from, direction, endless));
        traced.points.push_back(from + traced.hits.back().distance * direction);
    }
    return traced;
}

TEST(MovedSurfaces, AreHitWhereTheSnapshotHasThem) {
    Stage stage(everything_that_moves());
    ASSERT_EQ(stage.film().objects[1].mobility, scene::Mobility::rigid);
    ASSERT_EQ(stage.film().objects[8].mobility, scene::Mobility::deforming);
    EXPECT_FALSE(stage.tracer().is_instanced(0));
    EXPECT_TRUE(stage.tracer().is_instanced(3));
    for (int second = 0; second <= 2; ++second) {
        stage.pose(second);
        const Traced traced = trace_all(stage);
        std::vector<int> seen(stage.film().objects.size(), 0);
        for (std::size_t i = 0; i < traced.hits.size(); ++i) {
            const Hit& hit = traced.hits[i];
            if (!hit.found()) continue;
            ++seen[hit.address.object];
            const auto carried = scene::carry(hit.address, stage.world());
            ASSERT_TRUE(carried.has_value());
            EXPECT_LT(glm::distance(*carried, traced.points[i]), 2e-5f) << "object " << hit.address.object;
            const scene::Triangle t = scene::triangle_of(stage.world(), hit.address.object, hit.address.primitive);
            const glm::vec3 wound = glm::cross(t.b - t.a, t.c - t.a);
            EXPECT_GT(glm::dot(glm::normalize(hit.geometric_normal), glm::normalize(wound)), 0.9999f);
        }
        for (const std::size_t object : {0u, 1u, 3u, 8u}) EXPECT_GT(seen[object], 5) << object << " at " << second;
    }
}

TEST(ObjectsAlone, AreMetWhereTheyAreAmongOthers) {
    SceneBuilder builder = everything_that_moves();
    builder.film().materials[0].subsurface.emplace();
    Stage stage(builder);
    for (int second = 0; second <= 2; ++second) {
        stage.pose(second);
        std::vector<int> hidden(stage.film().objects.size(), 0);
        for (std::uint64_t i = 1; i <= 4000; ++i) {
            const glm::vec3 from{16 * core::halton(0, i) - 8, 9, 16 * core::halton(1, i) - 8};
            const glm::vec3 to{12 * core::halton(2, i) - 6, -1, 12 * core::halton(3, i) - 6};
            const renderer::RayQuery ray{from, glm::normalize(to - from), endless};
            const Hit first = stage.tracer().nearest(ray.origin, ray.direction, ray.far);
            if (!first.found()) continue;
            const Hit same = stage.tracer().nearest_of(first.address.object, ray);
            ASSERT_EQ(same.address.object, first.address.object);
            ASSERT_NEAR(same.distance, first.distance, 1e-4f);
            ASSERT_GT(glm::dot(glm::normalize(same.geometric_normal), glm::normalize(first.geometric_normal)), 0.9999f);
            const Hit floor = stage.tracer().nearest_of(0, ray);
            if (first.address.object == 0 || !floor.found()) continue;
            ++hidden[first.address.object];
            EXPECT_EQ(floor.address.object, 0u);
            EXPECT_GT(floor.distance, first.distance);
        }
        for (const std::size_t object : {1u, 3u, 8u}) EXPECT_GT(hidden[object], 5) << object << " at " << second;
    }
}

TEST(MovedSurfaces, MayBeMetOnlyNearWhereTheyAre) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(), true);
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material(), 12);
    b.move_object(ball, {{1, 1, 1}, {3, 1, 2}});
    Stage stage(b);
    for (const int second : {0, 1}) {
        stage.pose(second);
        const glm::vec3 middle = second == 0 ? glm::vec3(1) : glm::vec3(3, 1, 2);
        for (const float beside : {-0.46f, -0.34f, 0.0f, 0.34f, 0.46f}) {
            const glm::vec3 above = middle + glm::vec3(beside, 1, 0), way(0, -1, 0);
            EXPECT_EQ(stage.tracer().may_meet_dynamic(above, way, 2), std::abs(beside) < 0.4f) << beside;
            EXPECT_FALSE(stage.tracer().may_meet_dynamic(above, way, 0.5f)) << beside;
            EXPECT_FALSE(stage.tracer().may_meet_dynamic(above, -way, 2)) << beside;
        }
    }
}

TEST(RaysTogether, MeetWhatTheyMeetAlone) {
    // Rows of an eye's rays, which end within packets, among them some that cannot be traced and some that end too
    // soon.
    Stage stage(everything_that_moves());
    stage.pose(1);
    const glm::vec3 eye{-5, 6, 3};
    std::vector<renderer::RayQuery> rays;
    for (int y = 0; y < 45; ++y) {
        for (int x = 0; x < 45; ++x) {
            const glm::vec3 to{0.4f * static_cast<float>(x) - 8.8f, 0, 0.5f * static_cast<float>(y) - 14.1f};
            rays.push_back({eye, glm::normalize(to - eye), x % 9 == 4 ? 8.0f : endless});
        }
    }
    rays[20].direction.y = std::numeric_limits<float>::quiet_NaN();
    rays[21].far = -1;
    std::vector<Hit> together(rays.size());
    stage.tracer().nearest(rays, together);
    std::vector<int> seen(stage.film().objects.size(), 0);
    int missed = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit alone = stage.tracer().nearest(rays[i].origin, rays[i].direction, rays[i].far);
        ASSERT_EQ(together[i].found(), alone.found()) << i;
        if (!alone.found()) {
            ++missed;
            continue;
        }
        ++seen[alone.address.object];
        EXPECT_EQ(together[i].address.object, alone.address.object) << i;
        EXPECT_EQ(together[i].address.primitive, alone.address.primitive) << i;
        EXPECT_NEAR(together[i].address.u, alone.address.u, 1e-4f) << i;
        EXPECT_NEAR(together[i].address.v, alone.address.v, 1e-4f) << i;
        EXPECT_NEAR(together[i].distance, alone.distance, 1e-5f) << i;
        EXPECT_GT(glm::dot(glm::normalize(together[i].geometric_normal), glm::normalize(alone.geometric_normal)),
                  0.9999f);
    }
    EXPECT_GT(missed, 100);
    for (const std::size_t object : {0u, 1u, 3u, 8u}) EXPECT_GT(seen[object], 5) << object;
}

TEST(Posing, BackAndForthGivesWhatAFreshSceneGives) {
    Stage wandering(everything_that_moves());
    for (const int second : {2, 1, 2, 0, 1}) wandering.pose(second);
    const Stage fresh(everything_that_moves(), 32, 32, 1);
    const Traced a = trace_all(wandering), b = trace_all(fresh);
    for (std::size_t i = 0; i < a.hits.size(); ++i) {
        EXPECT_EQ(a.hits[i].address, b.hits[i].address);
        EXPECT_EQ(a.hits[i].distance, b.hits[i].distance);
    }
}

TEST(MovedVeils, DimLightWhereTheyAre) {
    // Two travelling sheets of one mesh with materials of their own: the filter must be told which of them it asks.
    SceneBuilder builder;
    const int mesh = builder.add_mesh(SceneBuilder::quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    for (const float alpha : {0.25f, 0.5f}) {
        const int veil = builder.add_material();
        builder.material(veil).alpha_mode = scene::AlphaMode::blend;
        builder.material(veil).base_color.a = alpha;
        const int sheet = builder.add_object(mesh, veil);
        builder.move_object(sheet, {{alpha * 20 - 5, 0, 0}, {0.3f, alpha, 0}});
    }
    Stage stage(builder);
    const auto light_at = [&](float x) { return stage.tracer().passes({x, 5, 0.3f}, {0, -1, 0}, endless).x; };
    EXPECT_NEAR(light_at(0.1f), 0.75f, 1e-6f);
    EXPECT_NEAR(light_at(5.1f), 0.5f, 1e-6f);
    EXPECT_EQ(light_at(2.5f), 1.0f);
    stage.pose(1);
    EXPECT_NEAR(light_at(0.2f), 0.375f, 1e-6f);
    EXPECT_EQ(light_at(5.1f), 1.0f);
}

TEST(AbsentObjects, AreNotHit) {
    // A still sheet, a travelling one and a growing one vanish after a second and come back.
    SceneBuilder builder;
    const int white = builder.add_material();
    const int still = builder.add_quad({-5, 3, 5}, {10, 0, 0}, {0, 0, -10}, white);
    const int moving = builder.add_quad({-5, 2, 5}, {10, 0, 0}, {0, 0, -10}, white);
    const int shrinking = builder.add_quad({-5, 1, 5}, {10, 0, 0}, {0, 0, -10}, white);
    const auto node = [&](int object) { return builder.film().objects[static_cast<std::size_t>(object)].node; };
    builder.move_object(moving, {{0, 0, 0}, {0, 0, 0.5f}, {0, 0, 1}});
    for (const int object : {still, moving})
        builder.add_track(scene::TrackTarget::visibility, node(object), 1, {0, 1, 2}, {1, 0, 1});
    for (scene::Track& track : builder.film().tracks)
        if (track.target == scene::TrackTarget::visibility) track.interpolation = scene::Interpolation::step;
    builder.add_track(scene::TrackTarget::scale, node(shrinking), 3, {0, 1, 2}, {1, 1, 1, 0, 0, 0, 1, 1, 1});
    Stage stage(builder);
    const auto first_hit = [&] { return stage.tracer().nearest({0.3f, 9, 0.2f}, {0, -1, 0}, endless); };
    const auto sees_light = [&] { return stage.tracer().passes({0.3f, 9, 0.2f}, {0, -1, 0}, endless).x == 1.0f; };
    EXPECT_EQ(first_hit().address.object, static_cast<std::uint32_t>(still));
    stage.pose(1);
    EXPECT_FALSE(first_hit().found());
    EXPECT_TRUE(sees_light());
    stage.pose(2);
    EXPECT_EQ(first_hit().address.object, static_cast<std::uint32_t>(still));
    EXPECT_FALSE(sees_light());
    EXPECT_TRUE(stage.tracer().nearest({0.3f, 2.5f, 0.2f}, {0, -1, 0}, 0.6f).found());
    EXPECT_TRUE(stage.tracer().nearest({0.3f, 1.5f, 0.2f}, {0, -1, 0}, 0.6f).found());
}

TEST(AbsentObjects, ThatNeverWereCanAppear) {
    SceneBuilder builder;
    const int white = builder.add_material();
    const int sheet = builder.add_quad({-5, 3, 5}, {10, 0, 0}, {0, 0, -10}, white);
    builder.add_track(scene::TrackTarget::visibility, builder.film().objects[static_cast<std::size_t>(sheet)].node, 1,
                      {0, 1}, {0, 1});
    builder.film().tracks.back().interpolation = scene::Interpolation::step;
    Stage stage(builder);
    EXPECT_FALSE(stage.tracer().nearest({0.3f, 9, 0.2f}, {0, -1, 0}, endless).found());
    stage.pose(1);
    EXPECT_TRUE(stage.tracer().nearest({0.3f, 9, 0.2f}, {0, -1, 0}, endless).found());
}

}  // namespace
}  // namespace render2mpeg::test
