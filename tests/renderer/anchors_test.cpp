#include "renderer/lights/anchors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"
#include "renderer/tree/light_trees.h"
#include "tests/renderer/anchor_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::AnchorStage;
using test::hall;
using test::SceneBuilder;

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

glm::dvec3 sum_of(const std::vector<LightPoint>& lights) {
    glm::dvec3 sum(0);
    for (const LightPoint& l : lights) sum += l.intensity;
    return sum;
}

double change(const std::vector<LightPoint>& a, const std::vector<LightPoint>& b) {
    double change = 0, all = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        change += std::abs(core::luminance(b[i].intensity) - core::luminance(a[i].intensity));
        all += core::luminance(a[i].intensity);
    }
    return change / all;
}

TEST(Anchors, HoldAllFluxThatPhotonsLeave) {
    AnchorStage stage(lamp_room(true, true));
    for (const double seconds : {0.0, 0.5, 1.0}) {
        stage.pose(seconds);
        const Anchors::Lit lit = stage.light();
        const PhotonResult photons = stage.photons();
        glm::dvec3 still(0), moving(0);
        for (std::size_t i = 0; i < photons.vpls.size(); ++i) {
            const scene::Object& object = stage.posed_scene().animation().objects[photons.addresses[i].object];
            (object.mobility == scene::Mobility::still ? still : moving) += glm::dvec3(photons.vpls[i].intensity);
        }
        ASSERT_GT(moving.x, 0.0);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(sum_of(lit.still)[k] / still[k], 1.0, 1e-4);
            EXPECT_NEAR(sum_of(lit.moving)[k] / moving[k], 1.0, 1e-4);
        }
    }
}

TEST(Anchors, AreOfAConstantNumberAtFixedPlaces) {
    AnchorStage stage(lamp_room(true, true));
    const Anchors::Lit before = stage.light();
    EXPECT_NEAR(static_cast<double>(before.still.size() + before.moving.size()), 600, 10);
    EXPECT_GE(before.moving.size(), 3u);
    stage.pose(1.0);
    const Anchors::Lit after = stage.light();
    ASSERT_EQ(before.still.size(), after.still.size());
    ASSERT_EQ(before.moving.size(), after.moving.size());
    for (std::size_t i = 0; i < before.still.size(); ++i) {
        EXPECT_EQ(before.still[i].position, after.still[i].position);
        EXPECT_EQ(before.still[i].disc2, after.still[i].disc2);
        EXPECT_EQ(before.still[i].id, after.still[i].id);
    }
    for (std::size_t i = 0; i < before.moving.size(); ++i) {
        const glm::vec3 moved = after.moving[i].position - before.moving[i].position;
        EXPECT_NEAR(glm::distance(moved, glm::vec3(3, 0, 0)), 0.0f, 1e-4f);
    }
}

TEST(Anchors, DependOnTheInstantAloneSlow) {
    AnchorStage stage(lamp_room(true, true));
    stage.pose(0.5);
    const Anchors::Lit one = stage.light();
    stage.pose(1.0);
    stage.light();
    stage.pose(0.5);
    const parallel::ThreadLimit limit(1);
    const Anchors::Lit two = stage.light();
    AnchorStage other(lamp_room(true, true));
    other.pose(0.5);
    const Anchors::Lit three = other.light();
    ASSERT_EQ(one.still.size(), two.still.size());
    ASSERT_EQ(one.still.size(), three.still.size());
    for (std::size_t i = 0; i < one.still.size(); ++i) {
        EXPECT_EQ(one.still[i].intensity, two.still[i].intensity);
        EXPECT_EQ(one.still[i].intensity, three.still[i].intensity);
        EXPECT_EQ(one.still[i].position, three.still[i].position);
    }
}

TEST(Anchors, KeepLightOnItsSideOfAWall) {
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
    AnchorStage stage(b);
    for (const bool left : {true, false}) {
        stage.pose(left ? 0.0 : 1.0);
        double lit = 0, leaked = 0;
        for (const LightPoint& l : stage.light().still) ((l.position.x < 3.0f) == left ? lit : leaked) += l.intensity.x;
        EXPECT_GT(lit, 0.0);
        EXPECT_LT(leaked, 0.002 * lit);
    }
}

/// Indirect light at places of all walls, at 12 instants while a ball crosses the room: curves, one for each place.
std::vector<std::vector<double>> light_behind_ball(const AnchorSettings& settings) {
    std::vector<std::vector<double>> light(12);
    std::unique_ptr<AnchorStage> stage;
    for (int frame = 0; frame < 12; ++frame) {
        if (!stage) stage = std::make_unique<AnchorStage>(lamp_room(false, true), settings);
        stage->pose(0.2 + frame / 25.0);
        const Anchors::Lit lit = stage->light();
        LightTrees light_trees = test::build_light_trees({}, lit.still, 1);
        light_trees.trees[LightTrees::dynamic_tree] = build_light_tree(LightType::oriented, lit.moving, 1);
        light_trees.point_clamp = {0.25f};
        GatherPoint places[12];
        const GatherPoint* points[12];
        for (std::uint32_t i = 0; i < 12; ++i) {
            places[i].point =
                stage->posed_scene().surface_at({0, i, 0.4f, 0.4f}, stage->posed_scene().front_normal(0, i));
            points[i] = &places[i];
        }
        GatherLanes lanes;
        fill(lanes, points);
        Gatherer gatherer(light_trees, stage->posed_scene().tracer());
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

TEST(AnchorsSlow, DoNotPopWhileABallCrossesARoom) {
    AnchorSettings fine{4000, 4};
    fine.photons = 1u << 17;
    const double usual = flicker(light_behind_ball({1500, 4})), reference = flicker(light_behind_ball(fine));
    EXPECT_LE(usual, 1.5 * reference);
    EXPECT_GT(reference, 0.0);
}

/// The largest change of two frames on end, as a share of all light.
double largest_change(const AnchorSettings& settings) {
    AnchorStage stage(hall(), settings);
    stage.pose(0.4);
    std::vector<LightPoint> last = stage.light().still;
    double largest = 0;
    for (int frame = 1; frame <= 2; ++frame) {
        stage.pose(0.4 + 0.04 * frame);
        std::vector<LightPoint> next = stage.light().still;
        largest = std::max(largest, change(last, next));
        last = std::move(next);
    }
    return largest;
}

TEST(Anchors, ChangeByAtMostATwentiethWhereALampMoves14CentimetresSlow) {
    AnchorSettings settings{2048, 4};
    const double usual = largest_change(settings);
    settings.photons = 1u << 17;
    const double smoothest = largest_change(settings);
    EXPECT_LE(usual, 0.05);
    EXPECT_GE(smoothest, 0.01);  // the light itself does change
    // Twice the photons hardly make it smoother.
    EXPECT_LE(usual, 1.2 * smoothest);
}

TEST(Anchors, OfADarkFilmAreNoneSlow) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(glm::vec3(0.0f)), true);
    b.add_point_light({1.7f, 1.6f, 2.1f}, 10.0f);
    AnchorStage stage(b);
    const Anchors::Lit lit = stage.light();
    EXPECT_TRUE(lit.still.empty());
    EXPECT_TRUE(lit.moving.empty());
}

TEST(Anchors, StandForTheSurfaceTheyLieOnSlow) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 4, 4}, b.add_material(glm::vec3(0.5f)), true);
    b.add_point_light({2, 2, 2}, 10.0f);
    AnchorStage stage(b, {2000, 4});
    double area = 0;
    for (const LightPoint& l : stage.light().still)
        area += core::luminance(l.intensity) > 0 ? 3.14159265 * l.disc2 : 0.0;
    EXPECT_NEAR(area / 96.0, 1.0, 0.2);
}

}  // namespace
}  // namespace render2mpeg::renderer
