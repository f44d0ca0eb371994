#include "renderer/lights/anchor_importance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;

/// Lights over a floor of which the camera sees the part about x = 0, and a wall at x = 10 that hides what is beyond.
struct Yard {
    Yard() {
        SceneBuilder b;
        b.add_quad({-40, 0, 40}, {80, 0, 0}, {0, 0, -80}, b.add_material());
        b.add_box({10, 0, -40}, {10.2f, 20, 40}, b.add_material());
        b.add_camera({0, 5, 0.01f}, {0, 0, 0});
        film = b.build();
        world = scene::snapshot_at(film, 0, {0, 1}, importance_format);
    }
    std::vector<float> importance(const std::vector<glm::vec3>& places) {
        const Plan plan = make_plan(scene::traits_of(film), {});
        PosedScene posed_scene(film, core::detect_isa(), plan);
        posed_scene.pose(world);
        std::vector<LightPoint> lights;
        for (const glm::vec3& p : places) {
            LightPoint l;
            l.position = p;
            l.normal = {0, -1, 0};
            lights.push_back(l);
        }
        return EyeImportance().of(posed_scene, lights);
    }
    scene::Animation film;
    scene::Snapshot world;
};

TEST(AnchorImportance, IsOfWhatLightsWhatIsSeen) {
    const std::vector<float> i = Yard().importance({{0, 3, 0}, {8, 3, 0}, {14, 3, 0}, {-38, 3, 0}});
    EXPECT_GT(i[0], 2.25f * i[1]);
    EXPECT_GT(i[1], 1.1f * i[2]);
    EXPECT_EQ(i[2], 0.25f);           // behind the wall
    EXPECT_NEAR(i[3], 0.25f, 0.02f);  // far off
}

TEST(AnchorImportance, IsOneWhereNothingIsSeen) {
    Yard yard;
    yard.film.objects.clear();
    yard.world = scene::snapshot_at(yard.film, 0, {0, 1}, importance_format);
    for (const float i : yard.importance({{0, 3, 0}, {5, 1, 0}})) EXPECT_EQ(i, 1.0f);
}

}  // namespace
}  // namespace render2mpeg::renderer
