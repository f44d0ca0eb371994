// Light on either side of what moves.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/color.h"
#include "renderer/lights/photon_splat.h"
#include "tests/renderer/door_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::AnchorStage;
using test::SceneBuilder;

struct Sides {
    double lit = 0, beyond = 0;
};

/// Light beyond the wall, and all other.
Sides sides(const std::vector<LightPoint>& lights) {
    Sides sum;
    for (const LightPoint& l : lights)
        (l.position.x > test::door_wall + 0.11f ? sum.beyond : sum.lit) += core::luminance(l.intensity);
    return sum;
}

TEST(AnchorDoors, LetNoLightThroughWhileTheyAreShut) {
    for (const int count : {400, 1500}) {
        AnchorStage stage(test::rooms_with_a_door(), {count, 4});
        stage.pose(0.5);
        EXPECT_EQ(sides(stage.photons().vpls).beyond, 0.0);
        const Sides still = sides(stage.light().still);
        ASSERT_GT(still.lit, 0.0);
        EXPECT_LT(still.beyond, 0.0005 * still.lit) << count;
    }
}

TEST(AnchorDoors, LetThroughWhatPhotonsCarryWhileTheyOpenSlow) {
    AnchorStage stage(test::rooms_with_a_door(), {3000, 4});
    for (const double seconds : {1.2, 1.5, 2.0}) {
        stage.pose(seconds);
        const Anchors::Lit lit = stage.light();
        const double landed = sides(stage.photons().vpls).beyond;
        ASSERT_GT(landed, 0.0);
        EXPECT_NEAR((sides(lit.still).beyond + sides(lit.moving).beyond) / landed, 1.0, 0.1) << seconds;
    }
}

TEST(AnchorDoors, PartTheSameNeighboursWhetherTheseAreKeptInListsOrNot) {
    AnchorStage stage(test::rooms_with_a_door());
    stage.pose(0.5);
    std::vector<AnchorPlace> places;
    for (const LightPoint& l : stage.light().still) {
        places.emplace_back();
        places.back().rest = {l.position, l.normal};
        places.back().disc2 = l.disc2;
    }
    const RayTracer& scene = stage.posed_scene().tracer();
    const PhotonSplatter listed(places, scene), searched(places, scene, 0);
    EXPECT_GT(listed.bytes(), searched.bytes() + 100 * places.size());
    EXPECT_EQ(listed.rays(), searched.rays());
    const OccludedNeighbours parted = listed.occluded_neighbours(scene), others = searched.occluded_neighbours(scene);
    EXPECT_TRUE(std::any_of(parted.hidden.begin(), parted.hidden.end(), [](std::uint32_t bits) { return bits != 0; }));
    EXPECT_EQ(parted.hidden, others.hidden);
    EXPECT_EQ(parted.rays, others.rays);

    std::vector<PhotonHit> photons;
    for (const LightPoint& vpl : stage.photons().vpls) photons.push_back({0, {vpl.position, vpl.normal}, glm::vec3(1)});
    std::vector<glm::dvec3> light(places.size(), glm::dvec3(0)), as_searched = light, as_if_open = light;
    listed.splat(photons, scene, &parted, light);
    searched.splat(photons, scene, &others, as_searched);
    listed.splat(photons, scene, nullptr, as_if_open);
    EXPECT_EQ(light, as_searched);
    EXPECT_NE(light, as_if_open);
}

TEST(AnchorDoors, LeaveLightOfStillRoomsAlone) {
    // What moves elsewhere changes no anchor that light comes to.
    SceneBuilder b;
    const int grey = b.add_material(glm::vec3(0.6f));
    b.add_box({0, 0, 0}, {4, 3, 4}, grey, true);
    b.add_point_light({2, 2, 2}, 20.0f);
    const int outside = b.add_box({-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, grey);
    b.move_object(outside, {{8, 1, 1}, {9, 1, 1}});
    AnchorStage stage(b);
    const std::vector<LightPoint> before = stage.light().still;
    stage.pose(1.0);
    const std::vector<LightPoint> after = stage.light().still;
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i].intensity, after[i].intensity);
}

}  // namespace
}  // namespace render2mpeg::renderer
