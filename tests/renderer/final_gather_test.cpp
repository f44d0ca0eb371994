#include "renderer/gather/final_gather.h"
#include "renderer/gather/ray_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/color.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/gather/near_light.h"
#include "renderer/paths/light_paths.h"
#include "renderer/tree/light_tree.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;
using test::Stage;

constexpr float albedo = 0.5f;

/// A gather point on a face's first triangle that is looked at from `eye`.
GatherPoint point_of(const Stage& stage, std::uint32_t object, glm::vec3 eye, glm::vec2 uv) {
    GatherPoint p;
    const core::SurfaceAddress address{object, 0, uv.x, uv.y};
    const glm::vec3 at = stage.posed_scene().surface_at(address, {0, 1, 0}).position;
    p.point = stage.posed_scene().surface_at(address, glm::normalize(eye - at));
    return p;
}

/// Light of some points that may each be off by this luminance.
std::vector<RayLight> light_of(const Stage& stage, const std::vector<GatherPoint>& points, float tolerance) {
    FinalGather gather(stage.posed_scene(), stage.plan());
    gather.forget({std::numeric_limits<float>::infinity(), 0.0f, {}});
    std::vector<GatherRequest> requests;
    for (std::size_t i = 0; i < points.size(); ++i)
        requests.push_back({&points[i],
                            {{tolerance, 0.0f, 0.0f}, 0.0f},
                            Stream(Purpose::hemisphere_rays, {.index = i}),
                            1e-3f,
                            RaysOf::all,
                            0u});
    return gather.gather(requests, {});
}

/// Sixteen points about a place of a face.
std::vector<GatherPoint> points_about(const Stage& stage, std::uint32_t object, glm::vec3 eye) {
    std::vector<GatherPoint> points;
    for (int i = 0; i < 16; ++i)
        points.push_back(
            point_of(stage, object, eye,
                     {0.25f + 0.03f * static_cast<float>(i % 4), 0.25f + 0.03f * static_cast<float>(i / 4)}));
    return points;
}

glm::vec3 mean_of(const std::vector<RayLight>& light) {
    glm::vec3 sum(0);
    for (const RayLight& l : light) sum += l.light[0] / static_cast<float>(light.size());
    return sum;
}

TEST(FinalGather, OfAWideLobeUnderAnEvenSkyVariesLittleAtGrazingAngles) {
    SceneBuilder b;
    const int varnish = b.add_material(glm::vec3(0.05f));
    b.material(varnish).ior = 1.5f;
    b.material(varnish).roughness = 0.4f;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, varnish);
    b.film().sky.color = {1, 1, 1};
    const Stage stage(b);
    for (const float height : {0.2f, 1.0f}) {
        const std::vector<GatherPoint> points = points_about(stage, 0, {-25, height, 20});
        const std::vector<RayLight> light = light_of(stage, points, 1e-5f);
        const Bsdf& bsdf = points[0].point.bsdf;
        ASSERT_TRUE(bsdf.has_lobe() && !bsdf.has_narrow_lobe());
        const double shown = shown_luminance(points[0], light[0].light);
        // By the cosine alone it is four and three times what is shown.
        EXPECT_LT(std::sqrt(light[0].batch_variance), 0.25 * shown) << height;
        double mean = 0;
        for (const RayLight& l : light) mean += shown_luminance(points[0], l.light) / 16;
        const float cosine = glm::dot(points[0].point.shading_normal, points[0].point.outgoing);
        const double expected = core::luminance(diffuse_albedo(bsdf, cosine) + glossy_albedo(bsdf, cosine));
        EXPECT_NEAR(mean, expected, 0.03 * expected) << height;
    }
}

TEST(FinalGather, OfAnEvenSkyIsTheSky) {
    SceneBuilder b;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(albedo)));
    b.film().sky.color = {0.5f, 0.6f, 0.8f};
    const Stage stage(b);
    for (const RayLight& l : light_of(stage, points_about(stage, 0, {0, 9, 1}), 0.01f)) {
        EXPECT_NEAR(l.light[0].x, 0.5f, 1e-5f);
        EXPECT_NEAR(l.light[0].z, 0.8f, 1e-5f);
        EXPECT_EQ(l.rays, 16u);  // all rays see the same
    }
}

TEST(FinalGather, OfAFurnaceIsAGeometricSum) {
    SceneBuilder b;
    const int wall = b.add_material(glm::vec3(albedo));
    b.material(wall).emission = glm::vec3(1);
    b.add_box({-1, -1, -1}, {1, 1, 1}, wall, true);
    const Stage stage(b);
    // What shines is seen by light trees; the rest bounces: 1 / (1 - albedo) - 1.
    const glm::vec3 light = mean_of(light_of(stage, points_about(stage, 0, {0, 0, 0}), 0.005f));
    EXPECT_NEAR(light.y, 1 / (1 - albedo) - 1, 0.02f);
}

/// A room under a sun that comes in by an open side, and a box in it.
SceneBuilder sunny_room() {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.7f)), red = b.add_material({0.6f, 0.1f, 0.1f});
    b.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    b.add_quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, white);
    b.add_quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, white);
    b.add_quad({-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, red);
    b.add_quad({2, 0, -2}, {0, 0, 4}, {0, 3, 0}, white);
    b.add_box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, white);
    b.add_sun({0.3f, -1, -0.9f}, 4);
    return b;
}

TEST(FinalGather, AgreesWithPathsSlow) {
    const Stage stage(sunny_room());
    const LightPaths paths(stage.posed_scene(), stage.plan());
    for (const std::uint32_t object : {1u, 2u, 4u}) {
        const std::vector<GatherPoint> points = points_about(stage, object, {0.2f, 1.7f, 0.9f});
        double truth = 0;
        constexpr std::uint64_t count = 8000;
        for (std::size_t k = 0; k < points.size(); ++k)
            for (std::uint64_t i = 0; i < count; ++i) {
                PathNumbers numbers(Stream(Purpose::true_paths, {.index = k}), i);
                truth +=
                    static_cast<double>(core::luminance(paths.scattered(points[k].point, numbers))) / (16.0 * count);
            }
        // Take away what the sun sends straight.
        double direct = 0;
        for (const GatherPoint& p : points)
            direct +=
                static_cast<double>(core::luminance(
                    p.point.bsdf.diffuse * 4.0f *
                    std::max(glm::dot(p.point.shading_normal, -glm::normalize(glm::vec3(0.3f, -1, -0.9f))), 0.0f) *
                    stage.tracer().passes(shadow_origin(p.point), -glm::normalize(glm::vec3(0.3f, -1, -0.9f)), 1e9f) /
                    3.14159265f)) /
                16;
        const double found = static_cast<double>(
            core::luminance(points[0].point.bsdf.diffuse * mean_of(light_of(stage, points, 0.0005f))));
        EXPECT_NEAR(found, truth - direct, 0.02 * (truth - direct)) << "object " << object;
        EXPECT_GT(found, 0.0);
    }
}

TEST(FinalGather, IsTheSameForAnyNumberOfThreads) {
    const Stage stage(sunny_room());
    const std::vector<GatherPoint> points = points_about(stage, 1, {0, 1.7f, 0.9f});
    std::vector<RayLight> one, all;
    {
        const parallel::ThreadLimit limit(1);
        one = light_of(stage, points, 0.005f);
    }
    all = light_of(stage, points, 0.005f);
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].light[0], all[i].light[0]);
        EXPECT_EQ(one[i].rays, all[i].rays);
    }
}

TEST(FinalGather, TakesRaysByThePowerOfItsTolerance) {
    const Stage stage(sunny_room());
    const std::vector<GatherPoint> points = points_about(stage, 1, {0, 1.7f, 0.9f});
    const auto rays = [&](float tolerance) {
        double sum = 0;
        for (const RayLight& l : light_of(stage, points, tolerance)) sum += l.rays;
        return sum;
    };
    const double coarse = rays(0.01f), fine = rays(0.0025f);
    EXPECT_GT(fine, 4 * coarse);
    EXPECT_LT(fine, 20 * coarse);
}

TEST(FinalGather, RaysThatGoOnAreThoseOfOneRequest) {
    const Stage stage(sunny_room());
    const std::vector<GatherPoint> points = points_about(stage, 1, {0, 1.7f, 0.9f});
    FinalGather gather(stage.posed_scene(), stage.plan());
    gather.forget({std::numeric_limits<float>::infinity(), 0.0f, {}});
    const auto rays_of = [&](std::uint32_t from, std::uint32_t rays) {
        GatherRequest r{&points[0], {}, Stream(Purpose::hemisphere_rays, {.index = 5}), 1e-3f};
        r.from = from;
        r.rays = rays;
        return gather.gather(std::span(&r, 1), {}).front();
    };
    // Cells learn from every question: ask all of them first.
    rays_of(0, 48);
    const RayLight whole = rays_of(0, 48), first = rays_of(0, 16), more = rays_of(16, 32);
    ASSERT_EQ(whole.rays, 48u);
    for (std::size_t k = 0; k < whole.light.size(); ++k) {
        const glm::vec3 both = glm::mix(first.light[k], more.light[k], 2.0f / 3.0f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(both[c], whole.light[k][c], 1e-5f + 1e-4f * whole.light[k][c]);
    }
    // How the first two batches of 8 differ is told with them.
    const RayLight one = rays_of(0, 8), two = rays_of(8, 8);
    EXPECT_NEAR(static_cast<double>(first.difference),
                shown_luminance(points[0], one.light) - shown_luminance(points[0], two.light),
                1e-5 + 1e-3 * static_cast<double>(std::abs(first.difference)));
}

TEST(FinalGather, KeepsItsTolerance) {
    const Stage stage(sunny_room());
    const std::vector<GatherPoint> points = points_about(stage, 1, {0, 1.7f, 0.9f});
    const std::vector<RayLight> truth = light_of(stage, points, 0.001f), coarse = light_of(stage, points, 0.02f);
    double squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double error = static_cast<double>(
            core::luminance(points[i].point.bsdf.diffuse * (truth[i].light[0] - coarse[i].light[0])));
        squares += error * error / 16;
    }
    EXPECT_LT(std::sqrt(squares), 0.02);   // a tolerance is 1.3 standard errors
    EXPECT_GT(std::sqrt(squares), 0.002);  // and no more rays are spent than it takes
}

TEST(FinalGather, LeaksNothingThroughAThinWall) {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.7f));
    // Two closed rooms that share a wall a millimetre thin; a lamp in one of them.
    b.add_box({-2, 0, -1}, {-0.001f, 2, 1}, white, true);
    b.add_box({0, 0, -1}, {2, 2, 1}, white, true);
    b.add_point_light({-1, 1.5f, 0}, 10);
    const Stage stage(b);
    const glm::vec3 lit = mean_of(light_of(stage, points_about(stage, 0, {-1, 1, 0}), 0.01f));
    const glm::vec3 dark = mean_of(light_of(stage, points_about(stage, 1, {1, 1, 0}), 0.01f));
    EXPECT_GT(lit.y, 0.1f);
    EXPECT_LE(dark.y, 0.002f * lit.y);
}

TEST(NearField, IsAShareThatFallsWithTheSquareOfTheDistance) {
    LightPoint lamp;
    lamp.type = LightType::punctual;
    lamp.intensity = glm::vec3(8);
    LightPoint part;
    part.intensity = glm::vec3(1);
    part.object = 3;
    std::vector<LightPoint> lights{lamp, part, part};
    lights[1].position = {10, 0, -0.1f};
    lights[2].position = {10, 0, 0.1f};
    const NearField field(lights, ViewSample{{}, 2.0f * lobe::inverse_pi});
    EXPECT_FLOAT_EQ(field.share({1, 0, 0}), 0.75f);
    EXPECT_NEAR(field.share({0, 2, 0}), 0.0f, 1e-6f);
    EXPECT_FLOAT_EQ(field.share({10, 0.5f, 0}), 0.75f);  // of both parts as one source
    // What would light all that is seen 64 times as much is hidden from it.
    const NearField hidden(lights, ViewSample{{{0, 0.1f, 0}, {0, 0, 0.1f}}, 2.0f * lobe::inverse_pi});
    EXPECT_FLOAT_EQ(hidden.share({1, 0, 0}), 0.0f);
    EXPECT_FLOAT_EQ(hidden.share({10, 0.5f, 0}), 0.75f);
    EXPECT_TRUE(NearField(lights, ViewSample()).empty());
    EXPECT_TRUE(NearField().empty());
}

/// A room whose lamp hangs in a shade, open below.
SceneBuilder shaded_room() {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.6f));
    b.add_box({-2, 0, -2}, {2, 3, 2}, white, true);
    b.add_quad({-0.3f, 1.9f, 0.3f}, {0.6f, 0, 0}, {0, 0.6f, 0}, white);
    b.add_quad({-0.3f, 1.9f, -0.3f}, {0.6f, 0, 0}, {0, 0.6f, 0}, white);
    b.add_quad({-0.3f, 1.9f, -0.3f}, {0, 0, 0.6f}, {0, 0.6f, 0}, white);
    b.add_quad({0.3f, 1.9f, -0.3f}, {0, 0, 0.6f}, {0, 0.6f, 0}, white);
    b.add_point_light({0, 2.1f, 0}, 5);
    return b;
}

TEST(NearLight, AndRaysTogetherGiveWhatRaysGive) {
    LitStage stage(shaded_room());
    const Plan plan = make_plan(scene::traits_of(stage.posed_scene().animation()), {});
    const std::vector<LightPoint> lights = stage.direct_points(1, 1);
    std::vector<GatherPoint> points;
    for (int i = 0; i < 16; ++i)
        points.push_back(stage.point_at(0, 2, {0.3f + 0.02f * static_cast<float>(i), 0.3f}, {0, 1, 0}));
    std::vector<GatherRequest> requests;
    for (std::size_t i = 0; i < points.size(); ++i)
        requests.push_back({&points[i],
                            {},
                            Stream(Purpose::hemisphere_rays, {.index = i}),
                            1e-3f,
                            RaysOf::all,
                            static_cast<std::uint32_t>(i)});
    const auto by_rays = [&](const NearField& field) {
        FinalGather gather(stage.posed_scene(), plan);
        SkyOfRays sees;
        sees.near_field = field;
        gather.forget(sees);
        return core::luminance(mean_of(gather.gather(requests, {})));
    };
    const NearField field(lights, ViewSample{{}, 1.0f});
    std::uint64_t rays = 0;
    LightTrees near;
    near.trees[LightTrees::static_tree] =
        build_light_tree(LightType::oriented, near_light(stage.posed_scene(), lights, lights, field, rays), 1);
    double by_points = 0;
    for (const GatherPoint& p : points)
        by_points += core::luminance(glm::vec3(test::gather_all(stage, near, p).indirect)) /
                     (0.6 * static_cast<double>(points.size()));
    const float all = by_rays({}), rest = by_rays(field);
    EXPECT_GT(by_points, 0.1f * all);
    EXPECT_NEAR(rest + by_points, all, 0.02f * all);
}

TEST(NearLight, IsOfTheViewBehindACutSlow) {
    renderer::Settings settings = test::small_frame(16, 16);
    const auto room_from = [&](glm::vec3 eye, glm::vec3 target) {
        SceneBuilder b = shaded_room();
        b.add_box({3, 0, -2}, {7, 3, 2}, b.add_material(glm::vec3(0.6f)), true);
        b.add_camera(eye, target);
        return test::FilmStage(b, settings);
    };
    test::FilmStage dark = room_from({6, 1, 1}, {4, 1, 0}), lit = room_from({1, 1, 1.5f}, {0, 1.5f, 0});
    lit.cut(0.3f);
    dark.cut(0.3f);
    ASSERT_NE(dark.renderer().statistics().indirect_points, lit.renderer().statistics().indirect_points);
    scene::Snapshot world = dark.at(1);
    world.camera = lit.at(1).camera;
    world.cut_before = true;
    const core::ToleranceMap tolerance = core::ToleranceMap::uniform(16, 16, {0.0f, 0.3f});
    dark.renderer().light(world, dark.renderer().look(world), {tolerance}).radiance;
    EXPECT_EQ(dark.renderer().statistics().indirect_points, lit.renderer().statistics().indirect_points);
}

/// Points of a room lit by its walls: what the errors of light points near its lamp hide in is mostly light of rays.
TEST(NearLight, ErrsByAShareOfTheLightThatRaysBringAsWell) {
    SceneBuilder b = shaded_room();
    b.add_camera({1, 1, 1.5f}, {0, 1.5f, 0});
    test::FilmStage stage(b, test::small_frame(48, 48));
    stage.cut(0.1f);
    const Statistics& found = stage.statistics();
    const double cut = 1.0 * found.indirect_clusters / found.cache.created;
    EXPECT_LT(cut, 130.0);  // 645 where rays are not known
    EXPECT_GT(cut, 14.0);
}

TEST(FinalGather, OfAnEmptyWorldIsNothing) {
    SceneBuilder b;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, b.add_material(glm::vec3(albedo)));
    b.add_point_light({0, 1, 0}, 1);
    const Stage stage(b);
    EXPECT_EQ(mean_of(light_of(stage, points_about(stage, 0, {0, 1, 0}), 0.01f)), glm::vec3(0));
    EXPECT_TRUE(light_of(stage, {}, 0.01f).empty());
}

}  // namespace
}  // namespace render2mpeg::renderer
