// The irradiance cache where things move: records never hold light of another instant.
#include <gtest/gtest.h>

#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::share_over;
constexpr int moving_size = 48;

Settings moving_settings(bool cache) {
    Settings s = test::lightcuts_frame(moving_size, moving_size);
    s.cache = cache ? CacheUse::on : CacheUse::off;
    s.vpls = 8192;
    return s;
}

constexpr glm::vec3 low{0.3f, 0.0f, 2.2f}, high{0.7f, 0.4f, 2.6f};

/// The furnished room with a lamp, and a small box that goes through these places, one a second.
test::SceneBuilder moving_room(const std::vector<glm::vec3>& places, bool walks = false, glm::vec3 reaches_to = high) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    if (walks)
        b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 10},
                    {2.0f, 1.6f, 3.8f, 2.4f, 1.6f, 3.8f});
    b.move_object(b.add_box(low, reaches_to, b.add_material({0.5f, 0.5f, 0.5f})), places);
    return b;
}

constexpr glm::vec3 here{0, 0, 0}, beside{0.6f, 0, 0.1f}, below{0, -9, 0};

TEST(CacheOfMovingLight, ShowsNoShadowOfWhatIsGoneAndShowsItAgainOnceItIsBackSlow) {
    const test::SceneBuilder b = moving_room({here, here, below, here}, false, {0.9f, 0.5f, 2.8f});
    FilmStage stage(b, moving_settings(true)), plain(b, moving_settings(false));
    stage.cut(0.05f, 0);
    const core::Radiance gone = plain.reference(2), back = plain.reference(3);
    ASSERT_GE(share_over(stage.cut(0.05f, 1), gone, 0.05f), 0.04) << "the box and its shadow count";
    EXPECT_LE(share_over(stage.cut(0.05f, 2), gone, 0.05f), 0.02);
    EXPECT_LE(share_over(stage.cut(0.05f, 3), back, 0.05f), 0.02);
}

TEST(CacheOfMovingLight, FollowsWhatAppearsSlow) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    const int box = b.add_box(low, high, b.add_material({0.5f, 0.5f, 0.5f}));
    b.add_track(scene::TrackTarget::visibility, b.film().objects[static_cast<std::size_t>(box)].node, 1, {0, 1, 2},
                {0, 1, 0});
    FilmStage stage(b, moving_settings(true)), plain(b, moving_settings(false));
    std::vector<core::Radiance> truth;
    for (int second = 0; second < 3; ++second) {
        truth.push_back(plain.reference(second));
        EXPECT_LE(share_over(stage.cut(0.05f, second), truth.back(), 0.05f), 0.02) << second;
    }
    EXPECT_GE(share_over(truth[0], truth[1], 0.05f), 0.015);
}

TEST(CacheOfMovingLight, FollowsWhatDeformsSlow) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    scene::Mesh mesh = test::SceneBuilder::box(low, high, false);
    scene::MorphTarget grown;
    for (const glm::vec3& p : mesh.positions) grown.positions.push_back({0, p.y > 0.2f ? 0.6f : 0.0f, 0});
    mesh.morph_targets.push_back(grown);
    const int body = b.add_object(b.add_mesh(mesh), b.add_material({0.5f, 0.5f, 0.5f}));
    b.film().objects[static_cast<std::size_t>(body)].morph_weights = {0};
    b.add_track(scene::TrackTarget::weights, b.film().objects[static_cast<std::size_t>(body)].node, 1, {0, 1, 2},
                {0, 1, 0});
    FilmStage stage(b, moving_settings(true)), plain(b, moving_settings(false));
    std::vector<core::Radiance> truth;
    for (int second = 0; second < 3; ++second) {
        truth.push_back(plain.reference(second));
        EXPECT_LE(share_over(stage.cut(0.05f, second), truth.back(), 0.05f), 0.02) << second;
    }
    EXPECT_GE(share_over(truth[0], truth[1], 0.05f), 0.015);
}

TEST(CacheOfMovingLight, IsOfLampsWhereNothingBouncesSlow) {
    Settings s = moving_settings(true);
    s.vpls = 0;
    FilmStage stage(moving_room({here, beside, here}, true), s);
    for (int chunk = 0; chunk < 2; ++chunk) {
        stage.renderer().start_chunk(stage.at(0));
        for (int second = 0; second < 3; ++second)
            EXPECT_LE(share_over(stage.cut(0.05f, second), stage.reference(second), 0.05f), 0.02) << second;
    }
}

TEST(CacheOfMovingLight, MeetsACameraCutAndAnotherChunkSlow) {
    test::SceneBuilder b = moving_room({here, beside, here, beside}, true);
    b.add_camera({3.5f, 1.2f, 3.6f}, {0.5f, 0.2f, 2.0f}, 1.1f);
    b.film().shots = {{0, 0}, {2, 1}};
    FilmStage stage(b, moving_settings(true));
    for (int chunk = 0; chunk < 2; ++chunk) {
        stage.renderer().start_chunk(stage.at(chunk));
        for (int second = chunk; second < 4; ++second)
            EXPECT_LE(share_over(stage.cut(0.05f, second), stage.reference(second), 0.05f), 0.025) << second;
    }
    EXPECT_GT(stage.statistics().cache.served, 0u);
}

TEST(CacheOfMovingLight, IsTheSameForAnyNumberOfThreadsSlow) {
    Settings s = moving_settings(true);
    s.format = {136, 80, 1.0f};
    s.direct_points = 32;
    s.vpls = 400;
    FilmStage one(moving_room({here, beside}, true), s), two(moving_room({here, beside}, true), s);
    for (int second = 0; second < 2; ++second) {
        core::Radiance a, b;
        {
            const parallel::ThreadLimit limit(1);
            a = one.cut(0.05f, second);
        }
        {
            const parallel::ThreadLimit limit(2);
            b = two.cut(0.05f, second);
        }
        EXPECT_TRUE(test::same_bytes(a, b)) << second;
    }
}

TEST(CacheOfMovingLight, CostsNoRayWhereAllRests) {
    FilmStage stage(moving_room({here, beside, beside, beside}), moving_settings(true));
    stage.cut(0.05f, 0);
    const core::Radiance moved = stage.cut(0.05f, 1);
    const std::uint64_t rays = stage.statistics().shadow_rays;
    EXPECT_TRUE(test::same_bytes(moved, stage.cut(0.05f, 2)));
    EXPECT_EQ(stage.statistics().shadow_rays, rays);
}

}  // namespace
}  // namespace render2mpeg::renderer
