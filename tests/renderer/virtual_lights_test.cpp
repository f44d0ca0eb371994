#include "renderer/lights/virtual_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"
#include "tests/renderer/door_stage.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::hall;
using test::SceneBuilder;
using test::VirtualLightStage;

constexpr double sphere_pi = std::numbers::pi;

/// A room with a block, a ball that crosses it, and a lamp that moves 14 cm every 1/25 s.
SceneBuilder lamp_room(bool moving_lamp, bool moving_ball) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {5, 3, 5}, b.add_material({0.7f, 0.6f, 0.5f}), true);
    b.add_box({3.0f, 0, 1.0f}, {4.0f, 1.5f, 2.0f}, b.add_material({0.3f, 0.5f, 0.7f}));
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material({0.8f, 0.2f, 0.2f}), 10);
    b.move_object(ball, {{1, 0.6f, 4}, {moving_ball ? 4.0f : 1.0f, 0.6f, 4}});
    const int light = b.add_point_light({1, 2.4f, 2}, 20.0f, {1, 0.8f, 0.6f});
    if (moving_lamp) {
        scene::Track track;
        track.target = scene::TrackTarget::translation;
        track.index = b.film().lights[static_cast<std::size_t>(light)].node;
        track.times = {0, 1};
        track.values = {1, 2.4f, 0.75f, 1, 2.4f, 4.25f};
        b.film().tracks.push_back(track);
    }
    return b;
}

double power_of(const std::vector<LightPoint>& lights) {
    double sum = 0;
    for (const LightPoint& l : lights) sum += core::luminance(l.intensity);
    return sum;
}

void expect_same(const std::vector<LightPoint>& a, const std::vector<LightPoint>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].position, b[i].position);
        EXPECT_EQ(a[i].intensity, b[i].intensity);
        EXPECT_EQ(a[i].disc2, b[i].disc2);
        EXPECT_EQ(a[i].id, b[i].id);
    }
}

/// Share of the lights that are in both, the same in place, light and id.
double kept(const std::vector<LightPoint>& before, const std::vector<LightPoint>& after) {
    std::map<std::uint32_t, const LightPoint*> by_id;
    for (const LightPoint& l : before) by_id[l.id] = &l;
    EXPECT_EQ(by_id.size(), before.size()) << "ids are unique";
    double same = 0;
    for (const LightPoint& l : after) {
        const auto found = by_id.find(l.id);
        if (found == by_id.end()) continue;
        same += found->second->position == l.position && found->second->intensity == l.intensity ? 1 : 0;
    }
    return same / static_cast<double>(after.size());
}

TEST(VirtualLights, HoldAllLightThatSurfacesReflect) {
    // Flux F in a closed room of reflectance r leaves surfaces with F (r + r^2 + ...).
    for (const float albedo : {0.3f, 0.7f}) {
        SceneBuilder b;
        b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(glm::vec3(albedo)), true);
        b.add_point_light({1.7f, 1.6f, 2.1f}, 10.0f);
        const double expected = 4 * sphere_pi * 10 * albedo / (1 - albedo);
        EXPECT_NEAR(sphere_pi * power_of(VirtualLightStage(b, {8000, 0}).light()) / expected, 1.0, 0.02) << albedo;
    }
}

TEST(VirtualLights, AreAboutAsManyAsWantedAndFarFewerChangeThanStayWhereABallMoves) {
    VirtualLightStage stage(lamp_room(false, true), {4000, 4});
    const std::vector<LightPoint> before = stage.light();
    EXPECT_NEAR(static_cast<double>(before.size()), 4000, 400);
    stage.pose(0.04);
    const double same = kept(before, stage.light());
    EXPECT_GE(same, 0.9);
    EXPECT_LE(same, 0.999) << "the ball hides and sends on some";
}

TEST(VirtualLights, MoveWithTheirLamp) {
    // The first bounce of a photon moves as far as its lamp's shadow does.
    VirtualLightStage stage(lamp_room(true, false), {4000, 1});
    std::map<std::uint32_t, glm::vec3> before;
    for (const LightPoint& l : stage.light()) before[l.id] = l.position;
    stage.pose(0.04);
    std::size_t near = 0, found = 0;
    for (const LightPoint& l : stage.light()) {
        const auto place = before.find(l.id);
        if (place == before.end()) continue;
        ++found;
        near += glm::distance(place->second, l.position) < 0.6f ? 1 : 0;
    }
    EXPECT_GE(found, before.size() * 99 / 100);
    EXPECT_GE(near, found * 9 / 10);
}

TEST(VirtualLights, OfOneLampStayWhileAnotherFlickers) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {6, 3, 4}, b.add_material(glm::vec3(0.6f)), true);
    b.add_point_light({1.5f, 1.5f, 2}, 10.0f);
    b.add_track(scene::TrackTarget::light_intensity, b.add_point_light({4.5f, 1.5f, 2}, 10.0f), 1, {0, 1, 2},
                {1, 0.25f, 0});
    VirtualLightStage stage(b, {4000, 4});
    const std::vector<LightPoint> bright = stage.light();
    stage.pose(1);
    const std::vector<LightPoint> dim = stage.light();
    ASSERT_EQ(bright.size(), dim.size());
    std::size_t same = 0;
    for (std::size_t i = 0; i < dim.size(); ++i) {
        EXPECT_EQ(dim[i].position, bright[i].position);
        EXPECT_EQ(dim[i].id, bright[i].id);
        same += dim[i].intensity == bright[i].intensity ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(same) / static_cast<double>(dim.size()), 0.5, 0.25);
    stage.pose(2);
    EXPECT_EQ(stage.light().size(), same) << "those of the lamp that is off are gone";
}

TEST(VirtualLights, DependOnTheInstantAlone) {
    VirtualLightStage stage(lamp_room(true, true));
    stage.pose(0.5);
    const std::vector<LightPoint> one = stage.light();
    stage.pose(1.0);
    stage.light();
    stage.pose(0.5);
    {
        const parallel::ThreadLimit limit(1);
        expect_same(one, stage.light());
    }
    const parallel::ThreadLimit limit(2);
    VirtualLightStage other(lamp_room(true, true));
    other.pose(0.5);
    expect_same(one, other.light());
}

TEST(VirtualLights, KeepLightOnItsSideOfAWall) {
    // Two rooms side by side, a wall of 2 cm between, lit in turn.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {6, 3, 3}, grey, true);
    b.add_box({2.99f, 0, 0}, {3.01f, 3, 3}, grey);
    for (const bool left : {true, false}) {
        scene::Track track;
        track.target = scene::TrackTarget::light_intensity;
        track.index = b.add_point_light({left ? 1.5f : 4.5f, 1.5f, 1.5f}, 10.0f);
        track.width = 1;
        track.times = {0, 1};
        track.values = {left ? 1.0f : 0.0f, left ? 0.0f : 1.0f};
        b.film().tracks.push_back(track);
    }
    VirtualLightStage stage(b);
    for (const bool left : {true, false}) {
        stage.pose(left ? 0.0 : 1.0);
        double lit = 0, leaked = 0;
        for (const LightPoint& l : stage.light()) ((l.position.x < 3.0f) == left ? lit : leaked) += l.intensity.x;
        EXPECT_GT(lit, 0.0);
        EXPECT_EQ(leaked, 0.0);
    }
}

TEST(VirtualLights, PassADoorOnlyWhileItIsOpen) {
    VirtualLightStage stage(test::rooms_with_a_door(), {3000, 4});
    const auto beyond = [&] {
        double sum = 0;
        for (const LightPoint& l : stage.light())
            sum += l.position.x > test::door_wall + 0.11f ? core::luminance(l.intensity) : 0.0f;
        return sum;
    };
    stage.pose(0.5);
    EXPECT_EQ(beyond(), 0.0);
    double last = 0;
    for (const double seconds : {1.2, 1.5, 2.0}) {
        stage.pose(seconds);
        const double now = beyond();
        EXPECT_GT(now, last) << seconds;
        last = now;
    }
}

/// Indirect light at places of all walls, at 12 instants on end: curves, one for each place.
std::vector<std::vector<double>> light_on_walls(const SceneBuilder& room, int vpls) {
    std::vector<std::vector<double>> light(12);
    VirtualLightStage stage(room, {vpls, 4});
    for (int frame = 0; frame < 12; ++frame) {
        stage.pose(0.2 + frame / 25.0);
        LightTrees light_trees = test::build_light_trees({}, stage.light(), 1);
        light_trees.point_clamp = {0.25f};
        GatherPoint places[12];
        const GatherPoint* points[12];
        for (std::uint32_t i = 0; i < 12; ++i) {
            places[i].point =
                stage.posed_scene().surface_at({0, i, 0.4f, 0.4f}, stage.posed_scene().front_normal(0, i));
            points[i] = &places[i];
        }
        GatherLanes lanes;
        fill(lanes, points);
        Gatherer gatherer(light_trees, stage.posed_scene().tracer());
        GatheredLight gathered;
        gatherer.gather_all(lanes, gathered);
        for (int i = 0; i < 12; ++i)
            light[static_cast<std::size_t>(i)].push_back(core::luminance(gathered.indirect.at(i)));
    }
    return light;
}

/// How much curves bend from frame to frame, as a share of their mean.
double flicker(const std::vector<std::vector<double>>& curves) {
    double bends = 0, sum = 0;
    for (const std::vector<double>& light : curves) {
        for (std::size_t i = 1; i + 1 < light.size(); ++i) {
            bends += std::abs(light[i + 1] - 2 * light[i] + light[i - 1]);
            sum += light[i];
        }
    }
    return bends / sum;
}

TEST(VirtualLightsSlow, DoNotPopWhileABallOrALampCrossesARoom) {
    for (const bool lamp : {false, true}) {
        const SceneBuilder room = lamp_room(lamp, !lamp);
        const double usual = flicker(light_on_walls(room, 32768)), fine = flicker(light_on_walls(room, 131072));
        EXPECT_LE(usual, 0.02) << lamp;
        EXPECT_LE(usual, 2.0 * fine) << lamp;
        EXPECT_GT(fine, 0.0005) << lamp;
    }
}

TEST(VirtualLights, OfADarkFilmAreNone) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(glm::vec3(0.0f)), true);
    b.add_point_light({1.7f, 1.6f, 2.1f}, 10.0f);
    EXPECT_TRUE(VirtualLightStage(b).light().empty());
}

TEST(VirtualLights, FollowABoundedNumberOfPathsWhereLightMeetsAlmostNothing) {
    // Of 10^6 paths that the sun sends over two blocks a kilometre apart, about one meets either.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {1, 1, 1}, grey);
    b.add_box({1000, 0, 1000}, {1001, 1, 1001}, grey);
    b.add_sun({0.1f, -1, 0.1f}, 3.0f);
    const VirtualLightStage stage(b, {300, 4});
    EXPECT_LE(stage.paths(), 64u * 300u);
    EXPECT_GE(stage.paths(), 300u);
}

TEST(VirtualLights, AreNotManyMoreThanWantedWhereLightComesIndoors) {
    // A lamp far above all, that then is in a box.
    SceneBuilder b;
    b.add_box({0, 0, 0}, {2, 2, 2}, b.add_material(glm::vec3(0.8f)), true);
    const int light = b.add_point_light({0, 0, 0}, 10.0f);
    b.add_track(scene::TrackTarget::translation, b.film().lights[static_cast<std::size_t>(light)].node, 3, {0, 1},
                {1, 40, 1, 1, 1, 1});
    VirtualLightStage stage(b, {500, 0});
    EXPECT_GE(stage.paths(), 500u);
    stage.pose(1);
    const std::vector<LightPoint> indoors = stage.light();
    EXPECT_LE(indoors.size(), 4u * 500u * 11u / 10u);
    EXPECT_GE(indoors.size(), 400u);
    EXPECT_NEAR(sphere_pi * power_of(indoors) / (4 * sphere_pi * 10 * 4), 1.0, 0.05);
}

TEST(VirtualLights, AreNotManyMoreThanWantedWhereEachPathLeavesMany) {
    // Nothing is hit when paths are counted; then the lamp is in a white box, where each bounces forty times.
    SceneBuilder b;
    b.add_box({0, 0, 0}, {2, 2, 2}, b.add_material(glm::vec3(0.975f)), true);
    b.material(0).double_sided = false;
    const int light = b.add_point_light({0, 0, 0}, 10.0f);
    b.add_track(scene::TrackTarget::translation, b.film().lights[static_cast<std::size_t>(light)].node, 3, {0, 1},
                {0, 1e4f, 0, 1, 1, 1});
    VirtualLightStage stage(b, {500, 0});
    stage.pose(1);
    const std::vector<LightPoint> indoors = stage.light();
    EXPECT_LE(indoors.size(), 4u * 500u * 15u / 10u);
    EXPECT_GE(indoors.size(), 400u);
    EXPECT_NEAR(sphere_pi * power_of(indoors) / (4 * sphere_pi * 10 * 39), 1.0, 0.3) << "by some fifty paths";
}

TEST(VirtualLights, ComeThoughNoneLandedWhenTheirPathsWereCounted) {
    SceneBuilder b;
    b.add_quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, b.add_material(glm::vec3(0.6f)));
    const int light = b.add_point_light({0, -1, 0}, 10.0f);
    b.material(0).double_sided = false;
    b.add_track(scene::TrackTarget::translation, b.film().lights[static_cast<std::size_t>(light)].node, 3, {0, 1},
                {0, 1e4f, 0, 0, 1, 0});
    VirtualLightStage stage(b, {300, 4});
    EXPECT_GE(stage.paths(), 300u);
    EXPECT_LE(stage.paths(), 64u * 300u);
    stage.pose(1);
    EXPECT_GT(power_of(stage.light()), 0.0);
}

TEST(VirtualLights, StandForTheSurfaceTheyLieOn) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 4, 4}, b.add_material(glm::vec3(0.5f)), true);
    b.add_point_light({2, 2, 2}, 10.0f);
    double area = 0;
    for (const LightPoint& l : VirtualLightStage(b, {2000, 4}).light()) area += sphere_pi * l.disc2;
    EXPECT_NEAR(area / 96.0, 1.0, 0.2);
}

/// Light points evenly over a square of 10 x 10.
std::vector<LightPoint> square(std::uint64_t count, glm::vec3 normal = {0, 0, 1}, float z = 0) {
    std::vector<LightPoint> points(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        points[i].position = {core::halton(0, i) * 10, core::halton(1, i) * 10, z};
        points[i].normal = normal;
        points[i].intensity = glm::vec3(1);
    }
    return points;
}

double area_of(const std::vector<LightPoint>& points) {
    double sum = 0;
    for (const LightPoint& p : points) sum += sphere_pi * p.disc2;
    return sum;
}

TEST(Spread, CoversTheSurface) {
    auto front = square(4000);
    spread(front, 0.0f);
    EXPECT_NEAR(area_of(front) / 100, 1.0, 0.1);
    // The other side of a thin wall is another surface.
    auto both = square(4000);
    for (const LightPoint& p : square(4000, {0, 0, -1}, -1e-4f)) both.push_back(p);
    spread(both, 0.0f);
    for (std::size_t i = 0; i < front.size(); ++i) EXPECT_EQ(both[i].disc2, front[i].disc2);
}

TEST(Spread, GivesABrightPointMoreOfTheSurface) {
    auto points = square(4000);
    // Every fifth: halves and thirds of the sequence lie apart.
    for (std::size_t i = 0; i < points.size(); i += 5) points[i].intensity = glm::vec3(3);
    spread(points, 0.0f);
    double bright = 0;
    for (std::size_t i = 0; i < points.size(); i += 5) bright += sphere_pi * points[i].disc2;
    EXPECT_NEAR(area_of(points) / 100, 1.0, 0.1);
    EXPECT_NEAR(bright / area_of(points), 3.0 / 7.0, 0.03);
}

TEST(Spread, ScalesWithTheScene) {
    auto points = square(500), scaled = points;
    spread(points, 0.0f);
    for (LightPoint& p : scaled) p.position *= 64.0f;
    spread(scaled, 0.0f);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].disc2 * 4096.0f, scaled[i].disc2);
}

TEST(Spread, OfCoincidentDarkOrSinglePointsIsFinite) {
    std::vector<LightPoint> points(50);
    for (const float intensity : {0.0f, 1.0f}) {
        for (LightPoint& p : points) p.intensity = glm::vec3(intensity);
        spread(points, 3.0f);
        for (const LightPoint& p : points) EXPECT_TRUE(std::isfinite(p.disc2));
    }
    points.resize(1);
    spread(points, 3.0f);
    EXPECT_NEAR(points[0].disc2, 3.0 / sphere_pi, 1e-6);
    spread({}, 3.0f);
}

}  // namespace
}  // namespace render2mpeg::renderer
