#include "renderer/lights/light_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

constexpr float float_pi = std::numbers::pi_v<float>;

glm::dvec3 flux_of(const std::vector<LightPoint>& points) {
    glm::dvec3 sum(0);
    for (const LightPoint& p : points) sum += p.intensity;
    return sum;
}

TEST(LightPoints, AreExactlyOneForEachPunctualLight) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_material());
    b.add_point_light({1, 2, 3}, 5.0f, {1, 0.5f, 0.25f});
    b.add_sun({0, -1, 0}, 2.0f);
    scene::Light spot;
    spot.kind = scene::LightKind::spot;
    spot.intensity = 7;
    spot.inner_cone = 0.2f;
    spot.outer_cone = 0.5f;
    spot.range = 9;
    spot.node = 0;
    b.add_light(spot);
    LitStage stage(b);
    const auto points = stage.direct_points(256, 1);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points[0].type, LightType::punctual);
    EXPECT_EQ(points[0].spot.outer_cosine(), -1);
    EXPECT_EQ(points[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(points[0].intensity, glm::vec3(5, 2.5f, 1.25f));
    EXPECT_EQ(points[1].type, LightType::directional);
    EXPECT_NEAR(points[1].normal.y, -1, 1e-6f);
    EXPECT_EQ(points[2].type, LightType::punctual);
    EXPECT_EQ(points[2].range, 9);
    // Full inside the inner cone, nothing outside the outer one.
    EXPECT_NEAR(points[2].spot.falloff(std::cos(0.2f)), 1, 1e-3f);
    EXPECT_NEAR(points[2].spot.outer_cosine(), std::cos(0.5f), 1e-3f);
}

TEST(LightPoints, OfASpotThatFallsOffSmoothlyDimByTheCosine) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_material());
    scene::Light spot;
    spot.kind = scene::LightKind::spot;
    spot.inner_cone = 0.4f;
    spot.outer_cone = 1.0f;
    spot.smooth_cosine = true;
    spot.node = 0;
    b.add_light(spot);
    LitStage stage(b);
    const LightPoint p = stage.direct_points(16, 1).at(0);
    const double inner = std::cos(0.4), outer = std::cos(1.0);
    for (const double angle : {0.0, 0.3, 0.5, 0.8, 0.99, 1.2}) {
        const double c = std::cos(angle), t = std::clamp((c - outer) / (inner - outer), 0.0, 1.0);
        EXPECT_NEAR(p.spot.falloff(static_cast<float>(c)), c * t * t * (3 - 2 * t), 1e-5);
    }
}

TEST(LightPoints, OfEmissiveSurfacesCarryTheirExactPower) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, b.add_emitter({1, 2, 4}));
    b.add_sphere({5, 5, 5}, 0.5f, b.add_emitter({10, 10, 10}), 12);
    LitStage stage(b);
    for (const int count : {1, 16, 333}) {
        const auto points = stage.direct_points(count, 1);
        EXPECT_NEAR(static_cast<double>(points.size()), std::max(count, 2), 2.0);
        glm::dvec3 panel(0);
        double ball = 0, ball_area = 0;
        for (const LightPoint& p : points) {
            if (p.object == 0) {
                panel += p.intensity;
                EXPECT_NEAR(p.position.z, 0, 1e-5f);
                EXPECT_GT(p.position.z, 0);
            } else {
                ball += p.intensity.x;
                ball_area += p.disc2 * float_pi;
            }
        }
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(panel[k], 6.0 * (1 << k), 1e-3);
        EXPECT_NEAR(ball, 10 * ball_area, 1e-3 * ball);
        EXPECT_NEAR(ball_area, float_pi, 0.03 * float_pi);  // of the polyhedron
    }
}

TEST(LightPoints, LieInProportionToPower) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_emitter({1, 1, 1}));
    b.add_quad({5, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_emitter({3, 3, 3}));
    b.add_quad({9, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_emitter({1e-6f, 1e-6f, 1e-6f}));
    LitStage stage(b);
    int count[3] = {};
    for (const LightPoint& p : stage.direct_points(400, 1)) ++count[p.object];
    EXPECT_NEAR(count[0], 100, 1);
    EXPECT_NEAR(count[1], 300, 1);
    EXPECT_EQ(count[2], 1);  // faint, but not black
}

// A lamp of two long triangles, from as far as six of its points lie apart.
TEST(LightPoints, OfALongStripLightAWallEvenly) {
    constexpr int points = 64;
    constexpr double length = 6, distance = 6 * length / points;
    for (const bool turned : {false, true}) {
        SceneBuilder b;
        const glm::vec3 along{static_cast<float>(length), 0, 0}, across{0, 0.06f, 0};
        // Turned, the quad's triangles have other first corners.
        b.add_quad(turned ? across : glm::vec3(0), turned ? -across : along, turned ? along : across,
                   b.add_emitter({1, 1, 1}));
        LitStage stage(b);
        double least = 1e9, most = 0;
        for (double x = 0.3 * length; x < 0.7 * length; x += 0.01 * length) {
            double irradiance = 0;
            for (const LightPoint& p : stage.direct_points(points, 1)) {
                const double d2 = distance * distance + std::pow(p.position.x - x, 2);
                irradiance += p.intensity.x * distance * distance / (d2 * d2);
            }
            least = std::min(least, irradiance);
            most = std::max(most, irradiance);
        }
        EXPECT_LT(most, 1.03 * least);
    }
}

TEST(LightPoints, ShineFromBothSidesOnlyWhereTheMaterialDoes) {
    for (const bool both : {false, true}) {
        SceneBuilder b;
        const int m = b.add_emitter({1, 1, 1});
        b.material(m).double_sided = both;
        b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, m);
        LitStage stage(b);
        double front = 0, back = 0;
        for (const LightPoint& p : stage.direct_points(64, 1)) (p.normal.z > 0 ? front : back) += p.intensity.x;
        EXPECT_NEAR(front, 1.0, 0.02);
        EXPECT_NEAR(back, both ? 1.0 : 0.0, 0.02);
    }
}

TEST(LightPoints, KeepIdsAndPlacesWhileTheirSurfaceStays) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_emitter({1, 1, 1}));
    const int mover = b.add_quad({3, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_emitter({2, 2, 2}));
    b.move_object(mover, {{0, 0, 0}, {0, 4, 0}});
    const scene::Animation film = b.build();
    const Plan plan = make_plan(scene::traits_of(film), {});
    PosedScene posed_scene(film, core::detect_isa(), plan);
    LightPoints points(posed_scene, plan, 100, 1);
    const scene::Snapshot first = test::snapshot(film, 0, 8, 8), second = test::snapshot(film, 1, 8, 8);
    points.place(posed_scene, first);
    const auto before = points.at(posed_scene);
    posed_scene.pose(second);
    const auto after = points.at(posed_scene);
    ASSERT_EQ(before.size(), after.size());
    std::set<std::uint32_t> ids;
    for (std::size_t i = 0; i < before.size(); ++i) {
        ids.insert(before[i].id);
        EXPECT_EQ(before[i].id, after[i].id);
        const bool moves = before[i].object == static_cast<std::uint32_t>(mover);
        const glm::vec3 moved = after[i].position - before[i].position;
        EXPECT_NEAR(moved.y, moves ? 4.0f : 0.0f, 1e-5f);
        if (!moves) {
            EXPECT_EQ(before[i].position, after[i].position);
        }
    }
    EXPECT_EQ(ids.size(), before.size());
}

TEST(LightPoints, OfAnEmitterThatIsOffWaitForItToShine) {
    SceneBuilder b;
    const int lamp = b.add_emitter({4, 4, 4});
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp);
    scene::Track track;
    track.target = scene::TrackTarget::emission;
    track.index = lamp;
    track.width = 1;
    track.times = {0, 1};
    track.values = {0, 1};
    b.film().tracks.push_back(track);
    const scene::Animation film = b.build();
    const Plan plan = make_plan(scene::traits_of(film), {});
    PosedScene posed_scene(film, core::detect_isa(), plan);
    LightPoints points(posed_scene, plan, 100, 1);
    const scene::Snapshot off = test::snapshot(film, 0, 8, 8), on = test::snapshot(film, 1, 8, 8);
    points.place(posed_scene, off);
    EXPECT_TRUE(points.at(posed_scene).empty());
    posed_scene.pose(on);
    EXPECT_NEAR(flux_of(points.at(posed_scene)).x, 4.0, 1e-3);
}

TEST(LightPoints, OfTheSkyCarryItsWholePower) {
    SceneBuilder b;
    b.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add_material());
    b.film().sky.color = {1, 2, 3};
    LitStage stage(b);
    const auto points = stage.direct_points(300, 1);
    EXPECT_EQ(points.size(), 300u);
    const glm::dvec3 sum = flux_of(points);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], 4 * float_pi * (k + 1), 1e-2 * (k + 1));
    double solid_angle = 0;
    for (const LightPoint& p : points) solid_angle += p.disc2 * float_pi;
    EXPECT_NEAR(solid_angle, 4 * float_pi, 0.05);
}

/// The sky's points over the floor of a well of 2 x 2 and `depth`, which a camera in it looks at, or up from; looked at
/// or not.
std::vector<LightPoint> sky_points(float depth, float look_at_height, bool looks) {
    SceneBuilder b;
    const int wall = b.add_material();
    b.material(wall).double_sided = true;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, wall);
    for (const float side : {-1.0f, 1.0f}) {
        b.add_quad({side, 0, -1}, {0, 0, 2}, {0, depth, 0}, wall);
        b.add_quad({-1, 0, side}, {2, 0, 0}, {0, depth, 0}, wall);
    }
    b.film().sky.color = {1, 2, 3};
    b.add_camera({0, 1, 0}, {0, look_at_height, 0.1f});
    const scene::Animation film = b.build();
    const Plan plan = make_plan(scene::traits_of(film), {});
    PosedScene posed_scene(film, core::detect_isa(), plan);
    LightPoints points(posed_scene, plan, 1000, 1);
    if (looks) points.look_at_sky(posed_scene);
    const scene::Snapshot first = test::snapshot(film, 0, 8, 8);
    posed_scene.pose(first);
    return points.at(posed_scene);
}

TEST(LightPoints, OfTheSkyLieWhereARoomLooks) {
    const auto near_zenith = [](const std::vector<LightPoint>& points) {
        return std::count_if(points.begin(), points.end(), [](const LightPoint& p) { return p.normal.y < -0.9f; });
    };
    const auto even = sky_points(5, 0, false), looked_at = sky_points(5, 0, true);
    EXPECT_NEAR(static_cast<double>(even.size()), 1000.0, 10.0);
    EXPECT_NEAR(static_cast<double>(looked_at.size()), 1000.0, 10.0);
    EXPECT_NEAR(static_cast<double>(near_zenith(even)), 50.0, 5.0);
    EXPECT_GT(near_zenith(looked_at), 400);

    // No light is lost, and each part's direction and size are its own.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(flux_of(looked_at)[k], flux_of(even)[k], 1e-3 * flux_of(even)[k]);
    glm::dvec3 down(0);
    double solid_angle = 0;
    for (const LightPoint& p : looked_at) {
        if (p.normal.y < 0) down -= static_cast<double>(p.normal.y) * glm::dvec3(p.intensity);
        solid_angle += p.disc2 * float_pi;
    }
    EXPECT_NEAR(down.x, float_pi, 0.01 * float_pi);  // irradiance of a floor
    EXPECT_NEAR(solid_angle, 4 * float_pi, 0.05);
}

TEST(LightPoints, OfTheSkyStayEvenInTheOpenAndWhereNoSurfaceIsSeen) {
    const struct { float depth, look_at_height; } cases[] = {{0.01f, 0}, {0.01f, 4}};
    for (const auto& c : cases) {
        const auto even = sky_points(c.depth, c.look_at_height, false),
                   looked_at = sky_points(c.depth, c.look_at_height, true);
        ASSERT_EQ(even.size(), looked_at.size());
        for (std::size_t i = 0; i < even.size(); ++i) EXPECT_EQ(even[i].normal, looked_at[i].normal);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
