#include "renderer/geometry/ray_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using renderer::Hit;
using renderer::offset_origin;
using renderer::RayTracer;
using renderer::ShadowPacket;
using renderer::SurfacePoint;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// What became of rays that start on a closed sphere.
struct SphereCounts {
    int points = 0, outward_blocked = 0, inward_free = 0, missed = 0;
};

/// Shoots at a sphere from around, and from where they meet it on, outwards (free) and inwards (blocked).
SphereCounts probe_sphere(const Stage& stage, glm::vec3 centre, float radius) {
    SphereCounts counts;
    const RayTracer& tracer = stage.tracer();
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto random = [&](int d) { return core::halton(d, i + 1); };
        const glm::vec3 from = centre + 3.0f * radius * core::sample_sphere({random(0), random(1)});
        const glm::vec3 to = centre + 0.9f * radius * core::sample_sphere({random(2), random(3)});
        const glm::vec3 direction = core::normalize_or(to - from, {0, 0, 1});
        const Hit hit = tracer.nearest(from, direction, infinity);
        if (!hit.found()) {
            ++counts.missed;
            continue;
        }
        ++counts.points;
        const SurfacePoint point = stage.posed_scene().surface_at(hit.address, -direction);
        const glm::vec3 n = point.geometric_normal;
        const glm::vec3 out = core::sample_cosine_hemisphere(n, {random(4), random(5)});
        if (tracer.passes(offset_origin(point, out), out, infinity).x != 1.0f) ++counts.outward_blocked;
        const glm::vec3 in = core::sample_cosine_hemisphere(-n, {random(4), random(5)});
        if (tracer.passes(offset_origin(point, in), in, infinity).x != 0.0f) ++counts.inward_free;
    }
    return counts;
}

/// A sphere whose distance from the origin survives completion: a second one lies on the other side.
SceneBuilder sphere_at(float radius, float radii_away, bool moves) {
    SceneBuilder builder;
    const int white = builder.add_material();
    const glm::vec3 centre = glm::vec3{0.6f, -0.48f, 0.64f} * (radius * radii_away);
    const glm::dquat turned = glm::angleAxis(0.7, glm::normalize(glm::dvec3{1, 2, 3}));
    const int mesh = builder.add_mesh(SceneBuilder::sphere(radius, 16));
    for (const float side : {1.0f, -1.0f}) {
        const int object = builder.add_object(mesh, white, glm::dvec3(side * centre), turned);
        if (moves) builder.move_object(object, {side * centre, side * centre + radius});
        if (radii_away == 0) break;
    }
    return builder;
}

TEST(ClosedSphere, NeitherLeaksNorShadowsItselfAtAnyScaleAndPlace) {
    for (const bool moves : {false, true}) {
        for (const float radius : {1e-4f, 1.0f, 1e3f, 1e6f}) {
            for (const float away : {0.0f, 1e2f, 1e4f}) {
                const Stage stage(sphere_at(radius, away, moves));
                const glm::vec3 centre(stage.world().objects[0].to_world[3]);
                const SphereCounts counts = probe_sphere(stage, centre, radius);
                SCOPED_TRACE(testing::Message()
                             << "radius " << radius << ", " << away << " radii away, moves " << moves);
                EXPECT_EQ(stage.tracer().is_instanced(0), moves);
                EXPECT_EQ(counts.outward_blocked, 0);
                EXPECT_EQ(counts.missed, 0);
                // Near an edge the offset, which grows with the distance from the origin, may step over the rim.
                EXPECT_LE(counts.inward_free, away > 1e3f ? counts.points / 20 : 0);
            }
        }
    }
}

TEST(Offset, IsSmallWhereTheSurfaceIsExact) {
    // On a floor at y = 0 the far corners of a wide triangle must not lift rays off contact shadows.
    SceneBuilder builder;
    builder.add_quad({-1000, 0, 1000}, {2000, 0, 0}, {0, 0, -2000}, builder.add_material());
    const Stage stage(builder);
    const Hit hit = stage.tracer().nearest({400, 5, 300}, {0, -1, 0}, infinity);
    ASSERT_TRUE(hit.found());
    const SurfacePoint point = stage.posed_scene().surface_at(hit.address, {0, 1, 0});
    EXPECT_LT(offset_origin(point, {0, 1, 0}).y - point.position.y, 1e-5f);
    EXPECT_EQ(stage.tracer().passes(offset_origin(point, {0, 1, 0}), {0.6f, 0.8f, 0}, infinity), glm::vec3{1.0f});
    EXPECT_EQ(stage.tracer().passes(offset_origin(point, {0, -1, 0}), {0.6f, -0.8f, 0}, infinity), glm::vec3{1.0f});
    EXPECT_FLOAT_EQ(hit.distance, 5.0f);
}

TEST(Needles, DoNotShadowThemselves) {
    // Triangles a million times longer than wide, in any direction.
    SceneBuilder builder;
    const int white = builder.add_material();
    constexpr int needles = 50;
    for (std::uint64_t i = 0; i < needles; ++i) {
        const glm::vec3 along = core::sample_sphere({core::halton(0, i + 1), core::halton(1, i + 1)});
        const glm::vec3 across = core::sample_sphere({core::halton(2, i + 1), core::halton(3, i + 1)});
        scene::Mesh mesh;
        const glm::vec3 corner{4.0f * static_cast<float>(i), 0.3f, 0.7f};
        mesh.positions = {corner, corner + along, corner + 1e-6f * across};
        mesh.triangles = {{0, 1, 2}};
        builder.add_object(builder.add_mesh(mesh), white);
    }
    const Stage stage(builder);
    int blocked = 0;
    ASSERT_EQ(stage.film().objects.size(), static_cast<std::size_t>(needles));
    for (std::uint32_t i = 0; i < needles; ++i) {
        ASSERT_EQ(stage.film().meshes[i].triangles.size(), 1u);
        for (std::uint64_t k = 1; k <= 40; ++k) {
            const glm::vec2 b = core::sample_triangle({core::halton(4, k), core::halton(5, k)});
            const glm::vec3 out = core::sample_sphere({core::halton(0, k), core::halton(1, k)});
            const SurfacePoint point = stage.posed_scene().surface_at({i, 0, b.x, b.y}, out);
            blocked += stage.tracer().passes(offset_origin(point, out), out, 1.0f).x != 1.0f;
        }
    }
    EXPECT_EQ(blocked, 0);
}

TEST(Rays, ThatAreNotFiniteAreMisses) {
    SceneBuilder builder;
    builder.add_sphere({0, 0, 0}, 1, builder.add_material());
    const Stage stage(builder);
    const RayTracer& tracer = stage.tracer();
    for (const float bad : {nan, infinity, -infinity, 1e30f}) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 origin{0, 0, 5}, direction{0, 0, -1};
            origin[axis] = bad;
            EXPECT_FALSE(tracer.nearest(origin, direction, infinity).found());
            EXPECT_EQ(tracer.passes(origin, direction, infinity), glm::vec3{1.0f});
            origin[axis] = 0;
            direction[axis] = bad;
            EXPECT_FALSE(tracer.nearest(origin, direction, infinity).found());
        }
    }
    EXPECT_FALSE(tracer.nearest({0, 0, 5}, {0, 0, -1}, nan).found());
    EXPECT_FALSE(tracer.nearest({0, 0, 5}, {0, 0, -1}, -1.0f).found());
    EXPECT_FALSE(tracer.nearest({0, 0, 5}, {0, 0, 0}, infinity).found());
    EXPECT_TRUE(tracer.nearest({0, 0, 5}, {0, 0, -1}, infinity).found());
}

TEST(Rays, BeforeAnythingIsPosedMiss) {
    SceneBuilder builder;
    builder.add_sphere({0, 0, 0}, 1, builder.add_material());
    const scene::Animation film = builder.build();
    const RayTracer tracer(film, core::detect_isa(), std::vector<bool>(film.materials.size(), false), {});
    EXPECT_FALSE(tracer.nearest({0, 0, 5}, {0, 0, -1}, infinity).found());
}

TEST(CoplanarSurfaces, ShowAFrontBeforeABack) {
    // A ball that is thinner than what counts as one plane: its underside has the same distance, and lower triangles.
    SceneBuilder builder;
    const int mesh = builder.add_mesh(SceneBuilder::sphere(1, 16));
    builder.add_object(mesh, builder.add_material(), {0, 0, 0}, {1, 0, 0, 0}, {1, 1e-6, 1});
    builder.add_object(mesh, builder.add_material(), {3, 0, 0}, {1, 0, 0, 0}, {1, -1e-6, 1});
    const Stage stage(builder);
    int hits = 0;
    for (const float middle : {0.0f, 3.0f})
        for (std::uint64_t i = 1; i <= 500; ++i) {
            const glm::vec3 to{middle + 2 * core::halton(0, i) - 1, 0, 2 * core::halton(1, i) - 1};
            const glm::vec3 from{middle, 0.5f, 4};
            const Hit hit = stage.tracer().nearest(from, glm::normalize(to - from), infinity);
            if (!hit.found()) continue;
            ++hits;
            const renderer::SurfacePoint point = stage.posed_scene().surface_at(hit.address, glm::normalize(from - to));
            EXPECT_FALSE(point.back_side) << i;
        }
    EXPECT_GT(hits, 600);
}

TEST(CoplanarSurfaces, ShowTheLowestObjectWhateverTheirTriangles) {
    // Two sheets in one oblique plane, cut up differently; the object that comes second in the tree's order must not
    // win.
    const glm::vec3 u{3, 0.3f, 0.1f}, v{-0.2f, 0.4f, 3}, corner{-1.5f, 0.7f, -1.5f};
    for (const bool swapped : {false, true}) {
        SceneBuilder builder;
        const int white = builder.add_material();
        const auto fan = [&] {
            scene::Mesh mesh;
            mesh.positions = {corner, corner + u, corner + u + v, corner + v, corner + 0.37f * u + 0.61f * v};
            mesh.triangles = {{4, 0, 1}, {4, 1, 2}, {4, 2, 3}, {4, 3, 0}};
            return mesh;
        };
        if (swapped) builder.add_object(builder.add_mesh(fan()), white);
        builder.add_quad(corner, u, v, white);
        if (!swapped) builder.add_object(builder.add_mesh(fan()), white);
        const Stage stage(builder);
        int hits = 0;
        std::vector<renderer::RayQuery> rays;
        for (std::uint64_t i = 1; i <= 1000; ++i) {
            const glm::vec3 to = corner + core::halton(0, i) * u + core::halton(1, i) * v;
            const glm::vec3 from{0.3f, 4.0f, 0.2f};
            rays.push_back({from, glm::normalize(to - from), infinity});
            const Hit hit = stage.tracer().nearest(from, rays.back().direction, infinity);
            if (hit.found()) {
                ++hits;
                ASSERT_EQ(hit.address.object, 0u) << i;
            }
        }
        EXPECT_GE(hits, 999);
        std::vector<Hit> together(rays.size());
        stage.tracer().nearest(rays, together);
        for (const Hit& hit : together) {
            ASSERT_TRUE(!hit.found() || hit.address.object == 0u);
        }
    }
}

TEST(Hits, AreTheSameForAnyNumberOfThreadsAtTheBuildSlow) {
    // Many copies of the same triangles: which one Embree meets first depends on its tree.
    SceneBuilder builder;
    const int white = builder.add_material();
    for (int i = 0; i < 40; ++i) builder.add_sphere({0, 0, 0}, 1.0f, white, 24);
    const auto trace = [&](int threads) {
        const parallel::ThreadLimit limit(threads);
        const Stage stage(builder);
        std::vector<core::SurfaceAddress> met;
        for (std::uint64_t i = 1; i <= 500; ++i) {
            const glm::vec3 from = 3.0f * core::sample_sphere({core::halton(0, i), core::halton(1, i)});
            met.push_back(stage.tracer().nearest(from, -from, infinity).address);
        }
        return met;
    };
    const auto one = trace(1);
    EXPECT_EQ(one, trace(2));
    for (const core::SurfaceAddress& address : one) EXPECT_EQ(address.object, 0u);
}

/// A stack of blended sheets at z = 0, -1, -2, ..., each letting `through` pass, and perhaps a wall behind.
SceneBuilder stack_of(int sheets, float alpha, bool wall) {
    SceneBuilder builder;
    const int veil = builder.add_material();
    builder.material(veil).alpha_mode = scene::AlphaMode::blend;
    builder.material(veil).base_color.a = alpha;
    for (int i = 0; i < sheets; ++i) builder.add_quad({-5, -5, static_cast<float>(-i)}, {10, 0, 0}, {0, 10, 0}, veil);
    const int white = builder.add_material();
    builder.add_quad(wall ? glm::vec3{-5, -5, -100} : glm::vec3{6, -5, -3}, {10, 0, 0}, {0, 10, 0}, white);
    return builder;
}

TEST(ShadowRays, LoseAtEveryLayerWhatItKeeps) {
    for (const int sheets : {0, 1, 2, 7, 16}) {
        const Stage stage(stack_of(sheets, 0.25f, false));
        const glm::vec3 light = stage.tracer().passes({0.1f, 0.2f, 3}, {0, 0, -1}, infinity);
        EXPECT_NEAR(light.x, std::pow(0.75, sheets), 2e-6) << sheets;
        EXPECT_EQ(light.x, light.z);
    }
    EXPECT_EQ(Stage(stack_of(17, 0.25f, false)).tracer().passes({0.1f, 0.2f, 3}, {0, 0, -1}, infinity),
              glm::vec3{0.0f});
    EXPECT_EQ(Stage(stack_of(3, 0.25f, true)).tracer().passes({0.1f, 0.2f, 3}, {0, 0, -1}, infinity), glm::vec3{0.0f});
    EXPECT_EQ(Stage(stack_of(40, 0.0f, false)).tracer().passes({0.1f, 0.2f, 3}, {0, 0, -1}, infinity), glm::vec3{1.0f});
}

TEST(ShadowPackets, AgreeWithSingleRays) {
    // A veil to the left, a wall to the right of it, nothing elsewhere, and lanes that must be ignored.
    SceneBuilder builder;
    const int veil = builder.add_material();
    builder.material(veil).alpha_mode = scene::AlphaMode::blend;
    builder.material(veil).base_color = {1, 1, 1, 0.5f};
    builder.add_quad({-4, -4, 0}, {5, 0, 0}, {0, 8, 0}, veil);
    builder.add_quad({-1, -4, -1}, {3, 0, 0}, {0, 8, 0}, builder.add_material());
    builder.add_sphere({3.2f, 0, -2}, 0.7f, builder.add_material());
    const Stage stage(builder);
    int blocked_rays = 0, dimmed_rays = 0;
    for (std::uint64_t round = 0; round < 200; ++round) {
        ShadowPacket packet{};
        glm::vec3 light[16];
        for (int i = 0; i < 16; ++i) {
            const std::uint64_t k = 16 * round + static_cast<std::uint64_t>(i) + 1;
            light[i] = {1.0f, 2.0f, 0.5f};
            packet.origin_x[i] = 10 * core::halton(0, k) - 5;
            packet.origin_y[i] = 10 * core::halton(1, k) - 5;
            packet.origin_z[i] = 4;
            packet.direction_x[i] = core::halton(2, k) - 0.5f;
            packet.direction_y[i] = core::halton(3, k) - 0.5f;
            packet.direction_z[i] = -3;
            packet.far[i] = 4 * core::halton(4, k);
            if (i == 5) packet.origin_x[i] = nan;
            if (i != 9) packet.active |= 1u << i;
        }
        const std::uint32_t blocked = stage.tracer().occluded(packet, light);
        EXPECT_EQ(stage.tracer().occluded(packet, nullptr), blocked);
        for (int i = 0; i < 16; ++i) {
            const bool lane_blocked = ((blocked >> i) & 1u) != 0;
            if (i == 5 || i == 9) {
                EXPECT_FALSE(lane_blocked);
                EXPECT_EQ(light[i].y, 2.0f);
                continue;
            }
            const glm::vec3 single = stage.tracer().passes(
                {packet.origin_x[i], packet.origin_y[i], packet.origin_z[i]},
                {packet.direction_x[i], packet.direction_y[i], packet.direction_z[i]}, packet.far[i]);
            EXPECT_EQ(lane_blocked, single == glm::vec3{0.0f});
            if (!lane_blocked) {
                EXPECT_EQ(light[i].y, 2.0f * single.y);
            }
            blocked_rays += lane_blocked;
            dimmed_rays += single.x > 0 && single.x < 1;
        }
    }
    EXPECT_GT(blocked_rays, 200);
    EXPECT_GT(dimmed_rays, 200);
}

TEST(CutOuts, StopShadowsWhereTheyAreSolid) {
    SceneBuilder builder;
    const int leaf = builder.add_material();
    builder.material(leaf).alpha_mode = scene::AlphaMode::mask;
    scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};  // alpha grows from left to right
    builder.add_object(builder.add_mesh(mesh), leaf);
    const Stage stage(builder);
    EXPECT_EQ(stage.tracer().passes({-0.5f, 0.1f, 1}, {0, 0, -1}, infinity), glm::vec3{1.0f});
    EXPECT_EQ(stage.tracer().passes({0.5f, 0.1f, 1}, {0, 0, -1}, infinity), glm::vec3{0.0f});
}

}  // namespace
}  // namespace render2mpeg::test
