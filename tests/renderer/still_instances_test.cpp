// Walls that share a mesh of many triangles are instances; they are walls all the same, and no dynamic objects.
#include <gtest/gtest.h>

#include <cmath>

#include "core/sampling.h"
#include "renderer/cut/gatherer.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;
using test::VirtualLightStage;

constexpr std::uint32_t first_wall = 1, last_wall = 3, mover = 4;

/// A room with a lamp at one end, three walls across it with gaps between, and something that moves before them: a
/// ball, or one more of these walls. `shared`: the walls share a mesh, in more triangles than are copied, most of which
/// lie within them.
SceneBuilder shared_room(bool shared, bool wall_moves = false) {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f});
    b.add_box({0, 0, 0}, {6, 3, 4}, grey, true);
    scene::Mesh wall = SceneBuilder::box({-0.0625f, -1, -0.5f}, {0.0625f, 1, 0.5f}, false);
    scene::Mesh filling = SceneBuilder::sphere(0.05f, 100);
    filling.normals.clear();
    SceneBuilder::append(wall, filling);
    const int mesh = b.add_mesh(wall);
    for (const double z : {0.5, 2.0, 3.5}) b.add_object(shared ? mesh : b.add_mesh(wall), grey, {3, 1, z});
    const int moving = wall_moves ? b.add_object(mesh, grey) : b.add_sphere({0, 0, 0}, 0.375f, grey, 12);
    b.move_object(moving, {{2, 1, 2}, {2, 1, 1}});
    b.add_point_light({1, 2, 2}, 20.0f, {1, 0.8f, 0.6f});
    b.add_point_light({1, 1, 3}, 10.0f);
    b.add_camera({5.5f, 1.6f, 2}, {3, 1, 2}, 1.2f);
    return b;
}

RayQuery some_ray(std::uint64_t i) {
    const auto u = [&](std::uint64_t k) { return core::uniform(3, i, k); };
    const glm::vec3 from(6 * u(0), 3 * u(1), 4 * u(2)), to(6 * u(3), 3 * u(4), 4 * u(5));
    return {from, to - from, 1.0f};
}

ShadowPacket packet_of(std::uint64_t first) {
    ShadowPacket packet;
    packet.active = 0xffff;
    for (std::uint64_t i = 0; i < 16; ++i) {
        const RayQuery ray = some_ray(first + i);
        packet.origin_x[i] = ray.origin.x, packet.direction_x[i] = ray.direction.x;
        packet.origin_y[i] = ray.origin.y, packet.direction_y[i] = ray.direction.y;
        packet.origin_z[i] = ray.origin.z, packet.direction_z[i] = ray.direction.z;
        packet.far[i] = ray.far;
    }
    return packet;
}

TEST(StillInstances, AreMetAsOtherWallsAreAndAreNoMovers) {
    for (const bool wall_moves : {false, true}) {
        const LitStage copied(shared_room(true, wall_moves)), baked(shared_room(false, wall_moves));
        const RayTracer &a = copied.posed_scene().tracer(), &b = baked.posed_scene().tracer();
        for (std::uint32_t i = first_wall; i <= last_wall; ++i) {
            EXPECT_TRUE(a.is_instanced(i));
            EXPECT_FALSE(b.is_instanced(i));
        }
        EXPECT_TRUE(a.has_dynamic_objects());
        int walls = 0, moving = 0, blocked = 0;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const RayQuery ray = some_ray(i);
            const Hit hit = a.nearest(ray.origin, ray.direction, ray.far);
            EXPECT_EQ(hit.address.object, b.nearest(ray.origin, ray.direction, ray.far).address.object) << i;
            walls += hit.found() && hit.address.object <= last_wall ? 1 : 0;
            moving += hit.found() && hit.address.object == mover ? 1 : 0;
            if (hit.found() && hit.address.object == mover)
                ASSERT_TRUE(a.may_meet_dynamic(ray.origin, ray.direction, ray.far)) << i;
            ASSERT_EQ(a.may_meet_dynamic(ray.origin, ray.direction, ray.far),
                      b.may_meet_dynamic(ray.origin, ray.direction, ray.far))
                << i;
            if (i % 16 != 0) continue;
            const ShadowPacket packet = packet_of(i);
            const std::uint32_t occluded = a.occluded(packet, nullptr);
            ASSERT_EQ(occluded, b.occluded(packet, nullptr)) << i;
            ASSERT_EQ((occluded & 1u) != 0, hit.found()) << i;
            blocked += static_cast<int>(__builtin_popcount(occluded));
        }
        EXPECT_GT(walls, 200);
        EXPECT_GT(moving, 100);
        EXPECT_GT(blocked, 400);
    }
}

TEST(StillInstances, AloneMakeNoFilmMove) {
    SceneBuilder b = shared_room(true);
    b.film().tracks.clear();
    const LitStage stage(b);
    EXPECT_TRUE(stage.posed_scene().tracer().is_instanced(first_wall));
    EXPECT_FALSE(stage.posed_scene().tracer().has_dynamic_objects());
    EXPECT_FALSE(stage.posed_scene().tracer().may_meet_dynamic({2.5f, 1, 0.5f}, {1, 0, 0}, 1.0f));
}

/// Cuts for groups of sixteen neighbours all over the floor.
struct Floor {
    std::uint64_t rays = 0;
    int clusters = 0;
    std::vector<glm::vec3> light;
};

Floor lit_floor(LitStage& stage) {
    const LightTrees light_trees = stage.light({64, 4000, 2, 0, GeometryClamp::none()});
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    Floor floor;
    for (int g = 0; g < 60; ++g) {
        std::vector<GatherPoint> points(lane_count);
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < lane_count; ++i) {
            const glm::vec3 above(0.3f + 0.6f * static_cast<float>(g % 10) + 0.02f * static_cast<float>(i % 4), 0.05f,
                                  0.3f + 0.6f * static_cast<float>(g / 10) + 0.02f * static_cast<float>(i / 4));
            const Hit hit = stage.posed_scene().tracer().nearest(above, {0, -1, 0}, 1.0f);
            points[i].point = stage.posed_scene().surface_at(hit.address, {0, 1, 0});
            pointers[i] = &points[i];
        }
        GatherLanes lanes;
        fill(lanes, pointers);
        GroupTolerance tolerance{};
        for (int i = 0; i < lane_count; ++i) tolerance.relative[i] = 0.02f;
        GatheredLight light;
        gatherer.gather(lanes, tolerance, {8, 4000}, light);
        floor.rays += light.shadow_rays;
        floor.clusters += light.direct_clusters + light.indirect_clusters;
        for (int i = 0; i < lane_count; ++i) floor.light.push_back(light.direct.at(i) + light.indirect.at(i));
    }
    return floor;
}

TEST(StillInstances, AreLitAndShadowByTheSameCutsAsOtherWalls) {
    LitStage copied(shared_room(true)), baked(shared_room(false));
    const Floor a = lit_floor(copied), b = lit_floor(baked);
    // Rounding moves what photons are guided by.
    const auto near = [](std::uint64_t x, std::uint64_t y) { return std::max(x, y) - std::min(x, y) <= y / 1000; };
    EXPECT_TRUE(near(a.rays, b.rays)) << a.rays << " " << b.rays;
    EXPECT_TRUE(near(a.clusters, b.clusters)) << a.clusters << " " << b.clusters;
    ASSERT_GT(b.clusters, 60 * 20);
    std::size_t others = 0;
    for (std::size_t i = 0; i < a.light.size(); ++i) {
        const float off = glm::distance(a.light[i], b.light[i]) / glm::length(b.light[i]);
        EXPECT_LE(off, 5e-3f) << i;
        others += off > 1e-4f ? 1 : 0;
    }
    EXPECT_LE(others, a.light.size() / 100) << "where a photon that went another way was a representative";
}

TEST(StillInstances, ReflectLightAsOtherWallsDo) {
    VirtualLightStage copied(shared_room(true)), baked(shared_room(false));
    const auto beyond = [](const std::vector<LightPoint>& lights) {
        double sum = 0;
        for (const LightPoint& l : lights) sum += l.position.x > 3.1f ? glm::length(l.intensity) : 0.0f;
        return sum;
    };
    for (const double seconds : {0.0, 0.6}) {
        copied.pose(seconds);
        baked.pose(seconds);
        const std::vector<LightPoint> a = copied.light(), b = baked.light();
        ASSERT_GT(b.size(), 300u);
        EXPECT_NEAR(static_cast<double>(a.size()) / static_cast<double>(b.size()), 1.0, 0.02);
        EXPECT_NEAR(beyond(a) / beyond(b), 1.0, 0.02);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
