#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace render2mpeg::scene {
namespace {

/// A film with a camera at `eye` and nothing that shines.
test::SceneBuilder unlit_film(glm::vec3 eye) {
    test::SceneBuilder builder;
    builder.add_camera(eye, eye + glm::vec3(0, 0, -1));
    return builder;
}

TEST(DefaultLight, OpenScenesGetANeutralSky) {
    test::SceneBuilder builder = unlit_film({0, 1, 5});
    builder.add_box({-1, 0, -1}, {1, 2, 1}, builder.add_material());
    const Animation film = builder.build();
    EXPECT_TRUE(film.sky.shines());
    EXPECT_TRUE(film.lights.empty());
    EXPECT_EQ(film.notes.back(), "no light: lit by a neutral sky");
}

TEST(DefaultLight, ARoomWithAnOpenSideIsNotClosedIn) {
    test::SceneBuilder builder = unlit_film({0, 1, 0});
    const int white = builder.add_material();
    builder.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    builder.add_quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, white);
    builder.add_quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, white);
    EXPECT_TRUE(builder.build().sky.shines());
}

TEST(DefaultLight, ADomeAboutEverythingShinesAndItsNeighboursStayAsTheyAre) {
    test::SceneBuilder builder = unlit_film({0, 1, 5});
    const int shared = builder.add_material({0.2f, 0.4f, 0.6f});
    builder.add_box({-1, 0, -1}, {1, 2, 1}, shared);
    const int dome = builder.add_sphere({0, 0, 0}, 20, shared);
    const Animation film = builder.build();
    EXPECT_FALSE(film.sky.shines());
    const auto material_of = [&](int object) {
        return film.materials[static_cast<std::size_t>(film.objects[static_cast<std::size_t>(object)].material)];
    };
    EXPECT_EQ(material_of(dome).emission, glm::vec3(0.2f, 0.4f, 0.6f));
    EXPECT_TRUE(material_of(dome).double_sided);
    EXPECT_FALSE(material_of(0).emits());
    EXPECT_NE(film.notes.back().find("shines"), std::string::npos) << film.notes.back();
}

TEST(DefaultLight, AClosedRoomOfManyPiecesGetsALampAtTheCamera) {
    test::SceneBuilder builder = unlit_film({0, 1, 0});
    const int white = builder.add_material();
    builder.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    builder.add_quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, white);
    for (const float side : {-2.0f, 2.0f}) {
        builder.add_quad({-2, 0, side}, {4, 0, 0}, {0, 3, 0}, white);
        builder.add_quad({side, 0, -2}, {0, 0, 4}, {0, 3, 0}, white);
    }
    const Animation film = builder.build();
    EXPECT_FALSE(film.sky.shines());
    ASSERT_EQ(film.lights.size(), 1u);
    EXPECT_EQ(film.lights[0].node, film.cameras[0].node);
    EXPECT_GT(film.lights[0].intensity, 0);
    EXPECT_NE(film.notes.back().find("lamp"), std::string::npos) << film.notes.back();
}

}  // namespace
}  // namespace render2mpeg::scene
