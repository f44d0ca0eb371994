// Anchors of scenes that light mostly misses, or reaches at moments only.
#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "renderer/lights/anchor_paths.h"
#include "renderer/lights/anchors.h"
#include "tests/renderer/anchor_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::AnchorStage;
using test::SceneBuilder;

double power_of(const std::vector<LightPoint>& lights) {
    double sum = 0;
    for (const LightPoint& l : lights) sum += core::luminance(l.intensity);
    return sum;
}

/// Mean distance of the anchors' light from a place, weighted by that light.
double spread_about(const std::vector<LightPoint>& lights, glm::vec3 place) {
    double sum = 0;
    for (const LightPoint& l : lights) sum += core::luminance(l.intensity) * glm::distance(l.position, place);
    return sum / power_of(lights);
}

TEST(PathsOfAnchors, FollowLandingsWithinBounds) {
    // Two VPLs a path, as in a room: half as many paths as photons.
    EXPECT_EQ(paths_of_anchors(4096, 0, 8, {1000, 2000}), 65536u);
    EXPECT_EQ(paths_of_anchors(4096, 1000, 8, {1000, 2000}), 500u);
    // One path of a million lands, or none: 64 for each anchor, or one for each photon.
    EXPECT_EQ(paths_of_anchors(4096, 0, 8, {1000000, 1}), 64u * 4096u);
    EXPECT_EQ(paths_of_anchors(4096, 0, 8, {1000000, 0}), 131072u);
    EXPECT_EQ(paths_of_anchors(4096, 0, 8, {0, 0}), 131072u);
    // However many a path was seen to leave.
    EXPECT_EQ(paths_of_anchors(4096, 0, 8, {1, 1000000}), 131072u / 8u);
    EXPECT_EQ(paths_of_anchors(1, 0, 0, {0, 0}), 32u);
    // Of many anchors each is due fewer photons.
    EXPECT_EQ(paths_of_anchors(50000, 0, 8, {1000, 1000}), 400000u);
    EXPECT_EQ(paths_of_anchors(100000, 0, 8, {1000, 1000}), 524288u);
    EXPECT_EQ(paths_of_anchors(1000000, 0, 8, {1000, 1000}), 2000000u);
}

TEST(SparseAnchors, FollowABoundedNumberOfPathsWhereTheSunMeetsAlmostNothing) {
    // Of 10^6 paths that the sun sends over two blocks a kilometre apart, about one meets either.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {1, 1, 1}, grey);
    b.add_box({1000, 0, 1000}, {1001, 1, 1001}, grey);
    b.add_sun({0.1f, -1, 0.1f}, 3.0f);
    const AnchorStage stage(b, {300, 4});
    EXPECT_LE(stage.anchors().paths(), 64u * 300u);
    EXPECT_GE(stage.anchors().paths(), 300u);
}

TEST(SparseAnchors, FollowABoundedNumberOfPathsFromALampInOpenSpace) {
    SceneBuilder b;
    b.add_box({500, 0, 0}, {500.5f, 0.5f, 0.5f}, b.add_material(glm::vec3(0.6f)));
    b.add_point_light({0, 0, 0}, 10.0f);
    const AnchorStage stage(b, {300, 4});
    EXPECT_LE(stage.anchors().paths(), 64u * 300u);
    EXPECT_GE(stage.anchors().paths(), 300u);
}

TEST(SparseAnchors, FollowEnoughPathsThoughNoneLandedWhenTheyWereChosen) {
    // Specks that stay dark must not count as landings.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    for (int i = 0; i < 40; ++i) {
        const int ball = b.add_sphere({0, 0, 0}, 0.001f, grey, 4);
        b.move_object(ball, {{100.0f + i, 0, 0}, {100.5f + i, 0, 0}});
    }
    b.add_point_light({0, 0, 0}, 10.0f);
    const AnchorStage stage(b, {300, 4});
    EXPECT_GE(stage.anchors().paths(), 300u);
    EXPECT_LE(stage.anchors().paths(), 64u * 300u);
}

TEST(SparseAnchors, FollowALampOnAPathOf500MetresSlow) {
    // A lamp 2 m above a road.
    SceneBuilder b;
    b.add_quad({-4, 0, 0}, {0, 0, 520}, {8, 0, 0}, b.add_material(glm::vec3(0.6f)));
    const int light = b.add_point_light({0, 2, 10}, 20.0f);
    b.add_track(scene::TrackTarget::translation, b.film().lights[static_cast<std::size_t>(light)].node, 3, {0, 10},
                {0, 2, 10, 0, 2, 510});
    AnchorStage stage(b, {2048, 4});
    for (const double seconds : {0.0, 0.16, 3.34, 7.77, 10.0}) {
        stage.pose(seconds);
        const std::vector<LightPoint> still = stage.light().still;
        const glm::vec3 below{0, 0, 10 + 50 * static_cast<float>(seconds)};
        ASSERT_GT(power_of(still), 0.0);
        EXPECT_LT(spread_about(still, below), spread_about(stage.photons().vpls, below) + 0.75) << seconds;
    }
}

TEST(SparseAnchors, KeepLightThatComesForAMomentNearWhereItLandsSlow) {
    // A lamp behind a door that stands open for 0.1 of 100 s, in a room that is dark but for that.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {10, 3, 4}, grey, true);
    b.add_box({4.9f, 0, 0}, {5.1f, 3, 1.5f}, grey);  // a wall with a doorway from z = 1.5 to 2.5
    b.add_box({4.9f, 0, 2.5f}, {5.1f, 3, 4}, grey);
    const int door = b.add_box({-0.15f, 0, -0.6f}, {0.15f, 3, 0.6f}, grey);
    const int node = b.film().objects[static_cast<std::size_t>(door)].node;
    b.add_track(scene::TrackTarget::translation, node, 3, {0, 50.05f, 50.1f, 50.2f, 50.25f, 100},
                {5, 0, 2, 5, 0, 2, 5, 8, 2, 5, 8, 2, 5, 0, 2, 5, 0, 2});
    b.add_point_light({2, 1.5f, 2}, 20.0f);
    AnchorStage stage(b, {2048, 4});
    const auto beyond = [&] {
        double sum = 0;
        for (const LightPoint& l : stage.light().still) sum += l.position.x > 5.2f ? core::luminance(l.intensity) : 0;
        return sum;
    };
    const auto landed_beyond = [&] {
        double sum = 0;
        for (const LightPoint& v : stage.photons().vpls) sum += v.position.x > 5.2f ? core::luminance(v.intensity) : 0;
        return sum;
    };
    stage.pose(20);
    const double shut = landed_beyond(), light_shut = beyond();
    stage.pose(50.15);
    const double open = landed_beyond(), light_open = beyond();
    ASSERT_GT(open, 0.0);
    EXPECT_EQ(shut, 0.0);
    EXPECT_LT(light_shut, 0.05 * light_open);
    // Some of what lands in the doorway is shared with the other side.
    EXPECT_NEAR(light_open / open, 1.0, 0.1);
}

TEST(SparseAnchors, HoldLightOfTheFirstFramesOfALongFilm) {
    // A lamp that is near its still tile for the first 2 of 600 s only, then below it.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
    b.add_box({-6, -7, -6}, {6, -6, 6}, grey);  // what the lamp lights later, from below the tile
    const int light = b.add_point_light({0, 1, 0}, 20.0f);
    b.add_track(scene::TrackTarget::translation, b.film().lights[static_cast<std::size_t>(light)].node, 3,
                {0, 2, 2.1f, 600}, {0, 1, 0, 0, 1, 0, 0, -3, 0, 0, -3, 0});
    AnchorStage stage(b, {1024, 4});
    for (const double seconds : {0.04, 1.0, 1.96}) {
        stage.pose(seconds);
        double on_tile = 0, landed = 0;
        for (const LightPoint& l : stage.light().still)
            on_tile += l.position.y > -1 && l.normal.y > 0 ? core::luminance(l.intensity) : 0;
        for (const LightPoint& v : stage.photons().vpls)
            landed += v.position.y > -1 && v.normal.y > 0 ? core::luminance(v.intensity) : 0;
        ASSERT_GT(landed, 0.0);
        EXPECT_NEAR(on_tile / landed, 1.0, 0.01) << seconds;
    }
}

TEST(SparseAnchors, LeaveAMoverInFrontOfAWallNoHoleInIt) {
    // Two rooms, a wall of 2 cm between; on both of its sides panels hang that move, a hand's breadth away.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {6, 3, 3}, grey, true);
    b.add_box({2.99f, 0, 0}, {3.01f, 3, 3}, grey);
    for (const float x : {2.9f, 3.1f}) {
        const int panel = b.add_box({-0.01f, -1.5f, -1.5f}, {0.01f, 1.5f, 1.5f}, grey);
        b.move_object(panel, {{x, 1.5f, 1.5f}, {x, 1.51f, 1.5f}});
    }
    for (const bool left : {true, false})
        b.add_track(scene::TrackTarget::light_intensity, b.add_point_light({left ? 1.5f : 4.5f, 1.5f, 1.5f}, 10.0f), 1,
                    {0, 1}, {left ? 1.0f : 0.0f, left ? 0.0f : 1.0f});
    AnchorStage stage(b);
    for (const bool left : {true, false}) {
        stage.pose(left ? 0.0 : 1.0);
        double lit = 0, leaked = 0;
        for (const LightPoint& l : stage.light().still)
            ((l.position.x < 3.0f) == left ? lit : leaked) += core::luminance(l.intensity);
        EXPECT_GT(lit, 0.0);
        EXPECT_LT(leaked, 0.002 * lit);
    }
}

/// Bytes of a hall's anchors between instants, each.
double bytes_each(int count) {
    AnchorStage stage(test::hall(), {count, 1});
    const Anchors::Lit lit = stage.light();
    return static_cast<double>(stage.anchors().bytes()) / static_cast<double>(lit.still.size() + lit.moving.size());
}

TEST(SparseAnchors, KeepListsOfNeighboursWhereTheyAreFewSlow) {
    const double each = bytes_each(4096);
    EXPECT_LE(each, 132 + 35.75);
    EXPECT_GE(each, 132 + 32.0);
}

TEST(SparseAnchorsSlow, TakeAtMost36BytesEachBetweenInstants) {
    const double each = bytes_each(40000);
    // With 4.25 of a light tree's plan and 80 of the tree: 120.
    EXPECT_LE(each, 35.75);
    EXPECT_GE(each, 32.0);
}

}  // namespace
}  // namespace render2mpeg::renderer
