// The default light of models that bring none.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/pose/pose.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "support/scene_builder.h"

namespace render2mpeg::scene {
namespace {

/// A ball that stands on y = 3, without light and camera.
Animation ball() {
    test::SceneBuilder builder;
    builder.add_sphere({5, 4, 0}, 1, builder.add_material());
    return builder.unfinished();
}

Animation in_studio(Animation film) {
    film.source = "film";
    complete(film, DefaultLight::studio);
    return film;
}

TEST(Studio, AFloorCatchesTheShadowBelowTheModelAndFades) {
    const Animation film = in_studio(ball());
    ASSERT_GE(film.stage, 0);
    const Object& floor = film.objects[static_cast<std::size_t>(film.stage)];
    const Pose pose = pose_at(film, 0);
    const glm::dvec3 middle(pose.world_of(floor.node)[3]);
    EXPECT_NEAR(middle.y, 3, 0.01);
    EXPECT_LT(middle.y, 3);
    const Mesh& mesh = film.meshes[static_cast<std::size_t>(floor.mesh)];
    EXPECT_EQ(mesh.colors.front().a, 1);
    EXPECT_EQ(mesh.colors.back().a, 0);
    for (const glm::uvec3& t : mesh.triangles)
        EXPECT_GT(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).y,
                  0);
}

TEST(Studio, TwoSoftSunsShineFromAbove) {
    const Animation film = in_studio(ball());
    ASSERT_EQ(film.lights.size(), 2u);
    const Pose pose = pose_at(film, 0);
    for (const Light& light : film.lights) {
        EXPECT_EQ(light.kind, LightKind::directional);
        EXPECT_GT(light.angle, 0.1f);
        EXPECT_GT(pose.world_of(light.node)[2].y, 0.5);
    }
    EXPECT_GE(film.sky.image, 0);
}

TEST(Studio, AStillModelFillsThePictureForFourSeconds) {
    const Animation film = in_studio(ball());
    EXPECT_DOUBLE_EQ(film.duration, 4);
    for (const int k : {0, 2, 4}) {
        const Snapshot now = snapshot_at(film, 0, {k, 1}, {100, 100, 1});
        const auto middle = now.camera.project(glm::vec3(5, 4, 0));
        ASSERT_TRUE(middle);
        // Its outline takes 85 to 95 % of the picture.
        const float radius = 100 / (2 * std::tan(0.5f * now.camera.lens().vertical_fov)) *
                             std::tan(std::asin(1 / glm::length(now.camera.position() - glm::vec3(5, 4, 0))));
        EXPECT_NEAR(middle->position.x, 50, 1);
        EXPECT_NEAR(middle->position.y, 50, 4);
        EXPECT_GT(radius, 42);
        EXPECT_LT(radius, 47);
    }
}

TEST(Studio, WhatMovesIsShownAsLongAsItMoves) {
    test::SceneBuilder builder;
    const int object = builder.add_object(builder.add_mesh(test::SceneBuilder::sphere(1, 12)), builder.add_material());
    builder.add_track(TrackTarget::translation, builder.film().objects[static_cast<std::size_t>(object)].node, 3,
                      {0, 10}, {0, 0, 0, 0, -2, 0});
    const Animation film = in_studio(builder.unfinished());
    EXPECT_DOUBLE_EQ(film.duration, 10);
    // The floor is below the lowest place of all.
    EXPECT_LT(pose_at(film, 0).world_of(film.objects[static_cast<std::size_t>(film.stage)].node)[3].y, -3);
}

TEST(Studio, ACameraAmongTheThingsSeesNoFloor) {
    test::SceneBuilder builder;
    const int grey = builder.add_material();
    for (const float x : {-5.0f, 5.0f})
        for (const float z : {-5.0f, 5.0f}) builder.add_box({x - 1, 0, z - 1}, {x + 1, 4, z + 1}, grey);
    builder.add_camera({0, 2, 0}, {0, 2, -1});
    const Animation film = in_studio(builder.unfinished());
    EXPECT_EQ(film.stage, -1);
    EXPECT_EQ(film.lights.size(), 2u);
}

TEST(Studio, OtherLightStaysAlone) {
    Animation lit = ball();
    lit.sky.color = glm::vec3(0.1f);
    EXPECT_TRUE(in_studio(lit).lights.empty());

    Animation dark = ball();
    complete(dark, DefaultLight::none);
    EXPECT_TRUE(dark.lights.empty());
    EXPECT_FALSE(dark.sky.shines());

    Animation even = ball();
    complete(even, DefaultLight::even);
    EXPECT_EQ(even.stage, -1);
    EXPECT_EQ(even.sky.color, glm::vec3(1));
    EXPECT_DOUBLE_EQ(even.duration, 8);
}

TEST(Studio, GlowThatAPictureGivesIsNoLight) {
    Animation film = ball();
    film.images.push_back({"eyes", "eyes.png", {}});
    film.materials[0].emission = glm::vec3(1);
    film.materials[0].emission_texture.image = 0;
    EXPECT_GE(in_studio(film).stage, 0);
    film.materials[0].emission = glm::vec3(5);
    EXPECT_EQ(in_studio(film).stage, -1);
    film.materials[0].emission = glm::vec3(1);
    film.materials[0].emission_texture.image = -1;
    EXPECT_EQ(in_studio(film).stage, -1);
}

}  // namespace
}  // namespace render2mpeg::scene
