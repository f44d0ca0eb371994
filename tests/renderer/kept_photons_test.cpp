// Photons that are kept from instant to instant.
#include <gtest/gtest.h>

#include "renderer/lights/kept_photons.h"
#include "tests/renderer/door_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::AnchorStage;
using test::SceneBuilder;

/// A floor and a wall under the sun, and a box that slides over the floor into the wall's shadow.
SceneBuilder yard() {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f});
    b.add_quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, grey);
    b.add_box({-3, 0, -3}, {-2.8f, 2, 3}, grey);
    const int box = b.add_object(b.add_mesh(SceneBuilder::box({0, 0, 0}, {0.6f, 0.6f, 0.6f}, false)), grey, {2, 0, 0});
    b.move_object(box, {{2, 0, 0}, {-2.5f, 0, 0.5f}});
    b.add_sun({0.5f, -1, 0.2f}, 3.0f);
    b.add_camera({3, 3, 3}, {0, 0, 0});
    return b;
}

struct KeptRays {
    std::uint64_t anew = 0, kept = 0;
};

/// Lights a film at instants with and without what is kept; the light must be the very same.
KeptRays light_both_ways(const SceneBuilder& film, std::initializer_list<double> instants, bool irradiance) {
    AnchorStage stage(film, {600, 0});
    KeptPhotons kept;
    KeptRays rays;
    for (const double seconds : instants) {
        stage.pose(seconds);
        const Anchors::Lit anew = stage.anchors().at(stage.posed_scene(), stage.direct(), irradiance),
                           same = stage.anchors().at(stage.posed_scene(), stage.direct(), irradiance, &kept);
        rays.anew += anew.rays;
        rays.kept += same.rays;
        EXPECT_EQ(anew.still.size(), same.still.size());
        for (std::size_t i = 0; i < anew.still.size(); ++i)
            EXPECT_EQ(anew.still[i].intensity, same.still[i].intensity) << "anchor " << i << " at " << seconds;
        for (std::size_t i = 0; i < anew.moving.size(); ++i)
            EXPECT_EQ(anew.moving[i].intensity, same.moving[i].intensity) << "moving anchor " << i << " at " << seconds;
        EXPECT_EQ(anew.irradiance, same.irradiance);
        EXPECT_NEAR(same.landed, anew.landed, 1e-9 * anew.landed);
        EXPECT_NEAR(same.lost, anew.lost, 1e-9 * anew.landed);
    }
    return rays;
}

TEST(KeptPhotons, BringTheSameLightForFewerRays) {
    const KeptRays door = light_both_ways(test::rooms_with_a_door(), {0.9, 1.1, 1.3, 1.3, 2.0, 0.5}, true);
    EXPECT_LT(door.kept, 7 * door.anew / 10);
    const KeptRays beams = light_both_ways(yard(), {0.0, 0.2, 0.4, 0.8, 0.1}, false);
    EXPECT_LT(beams.kept, 7 * beams.anew / 10);
}

TEST(KeptPhotons, AreForgottenWhenLampsMove) {
    const KeptRays rays = light_both_ways(test::hall(), {0.0, 0.5, 1.0}, false);
    EXPECT_EQ(rays.kept, rays.anew);
}

}  // namespace
}  // namespace render2mpeg::renderer
