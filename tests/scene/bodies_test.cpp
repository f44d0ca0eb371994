#include "scene/preparation/bodies.h"

#include <gtest/gtest.h>

#include "scene/preparation/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::scene {
namespace {

using test::SceneBuilder;

int add_glass(SceneBuilder& b, Thickness thickness) {
    const int m = b.add_material();
    b.material(m).transmission = 1;
    b.material(m).specular_glossiness = false;
    b.material(m).thickness = thickness;
    return m;
}

Body body_of(const Mesh& mesh, Thickness thickness) {
    SceneBuilder b;
    const int object = b.add_object(b.add_mesh(mesh), add_glass(b, thickness));
    b.add_point_light({0, 3, 0}, 1);
    return b.build().objects[static_cast<std::size_t>(object)].body;
}

const Mesh pane = SceneBuilder::box({0, 0, 0}, {1, 1, 0.002f}, false),
           brick = SceneBuilder::box({0, 0, 0}, {1, 1, 1}, false),
           sheet = SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});

TEST(Bodies, AreWhatMaterialsAndMeshesSay) {
    EXPECT_EQ(body_of(brick, Thickness::solid), Body::solid);
    EXPECT_EQ(body_of(brick, Thickness::solid_where_closed), Body::solid);
    EXPECT_EQ(body_of(brick, Thickness::thin), Body::none);
    EXPECT_EQ(body_of(pane, Thickness::solid), Body::slab);
    EXPECT_EQ(body_of(pane, Thickness::thin), Body::none);
    EXPECT_EQ(body_of(sheet, Thickness::solid_where_closed), Body::none);
    EXPECT_EQ(body_of(SceneBuilder::sphere(1, 24), Thickness::solid), Body::solid);
}

Body body_of(const Mesh& mesh, glm::dvec3 scaled) {
    SceneBuilder b;
    const int object = b.add_object(b.add_mesh(mesh), add_glass(b, Thickness::solid), {0, 0, 0}, {1, 0, 0, 0}, scaled);
    b.add_point_light({0, 3, 0}, 1);
    return b.build().objects[static_cast<std::size_t>(object)].body;
}

TEST(Bodies, ArePanesPartByPartAndAsTheyStandInTheWorld) {
    // A greenhouse: panes that face three ways in one mesh.
    Mesh house = pane;
    SceneBuilder::append(house, SceneBuilder::box({2, 0, 0}, {2.002f, 1, 1}, false));
    SceneBuilder::append(house, SceneBuilder::box({0, 3, 0}, {1, 3.002f, 1}, false));
    EXPECT_EQ(body_of(house, Thickness::solid), Body::slab);
    // A brick beside them bends light, and so does all of their mesh.
    SceneBuilder::append(house, SceneBuilder::box({5, 0, 0}, {6, 1, 1}, false));
    EXPECT_EQ(body_of(house, Thickness::solid), Body::solid);
    EXPECT_EQ(body_of(brick, {1, 1, 0.004}), Body::slab);
    EXPECT_EQ(body_of(brick, {1, 1, 0.2}), Body::solid);
    EXPECT_EQ(body_of(SceneBuilder::sphere(1, 24), {1, 1, 0.01}), Body::solid);
}

TEST(Bodies, ThatAreBentAtAnyTimeAreNoPanes) {
    for (const bool bent : {false, true}) {
        SceneBuilder b;
        Mesh mesh = pane;
        // To the side as a whole, or with one edge alone.
        MorphTarget target;
        for (const glm::vec3& p : mesh.positions)
            target.positions.emplace_back(0.0f, 0.0f, bent && p.x > 0.5f && p.z > 0 ? 1.0f : bent ? 0.0f : 1.0f);
        mesh.morph_targets = {target};
        const int object = b.add_object(b.add_mesh(mesh), add_glass(b, Thickness::solid));
        b.film().objects[static_cast<std::size_t>(object)].morph_weights = {0.0f};
        b.add_track(TrackTarget::weights, b.film().objects[static_cast<std::size_t>(object)].node, 1, {0, 4}, {0, 1});
        b.add_point_light({0, 3, 0}, 1);
        EXPECT_EQ(b.build().objects[static_cast<std::size_t>(object)].body, bent ? Body::solid : Body::slab);
    }
}

TEST(Bodies, ThatAreOpenAreTold) {
    SceneBuilder b;
    b.add_object(b.add_mesh(SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), add_glass(b, Thickness::solid));
    b.add_point_light({0, 3, 0}, 1);
    const Animation film = b.build();
    ASSERT_FALSE(film.notes.empty());
    EXPECT_NE(film.notes.front().find("light may stay inside"), std::string::npos);
}

TEST(Bodies, AreCausesOfTheirOwn) {
    SceneBuilder b;
    b.add_object(b.add_mesh(brick), add_glass(b, Thickness::solid));
    b.add_point_light({0, 3, 0}, 1);
    EXPECT_TRUE(traits_of(b.build()).has_bodies);
    EXPECT_TRUE(traits_of(b.build()).casts_caustics);
    b.material(0).transmission = 0;
    b.material(0).roughness = 1;
    EXPECT_FALSE(traits_of(b.build()).has_bodies);
    EXPECT_FALSE(traits_of(b.build()).casts_caustics);
}

}  // namespace
}  // namespace render2mpeg::scene
