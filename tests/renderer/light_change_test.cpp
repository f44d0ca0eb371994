// Light that changes from frame to frame: records follow it.
#include "renderer/geometry/light_change.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::share_over;
constexpr int side = 32;

Settings by_rays(CacheUse cache) {
    Settings s = test::small_frame(side, side);
    s.cache = cache;
    s.vpls = 800;
    return s;
}

scene::Snapshot snapshot_of(const scene::Animation& film, int second) {
    return test::snapshot(film, second, side, side);
}

/// The furnished room and a lamp, both dim.
test::SceneBuilder room() {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    return b;
}

void move_box(test::SceneBuilder& b) {
    b.move_object(b.add_box({0.3f, 0.0f, 2.2f}, {0.5f, 0.3f, 2.4f}, b.add_material({0.7f, 0.2f, 0.2f})),
                  {{0, 0, 0}, {0.2f, 0, 0.1f}, {0.4f, 0, 0.2f}, {0.6f, 0, 0.3f}});
}

void fade_lamp(test::SceneBuilder& b) {
    b.add_track(scene::TrackTarget::light_intensity, 0, 1, {0, 1, 2, 3}, {1, 0.7f, 0.4f, 0.2f});
}

/// Frames 1 to 3 keep their tolerance as well as frames that know nothing do, for less of their rays (0.77 here, where
/// 16 rays a record are most of them).
void expect_light_follows(void (*change)(test::SceneBuilder&)) {
    test::SceneBuilder b = room();
    change(b);
    FilmStage stage(b, by_rays(CacheUse::on)), anew(b, by_rays(CacheUse::on)), truth(b, by_rays(CacheUse::off));
    std::uint64_t kept_rays = 0, new_rays = 0;
    for (int second = 0; second < 4; ++second) {
        const core::Radiance exact = truth.cut(0.01f, second);
        anew.renderer().start_chunk(anew.at(second));
        const std::uint64_t kept_before = stage.statistics().gather_rays, new_before = anew.statistics().gather_rays;
        const core::Radiance kept = stage.cut(0.05f, second), fresh = anew.cut(0.05f, second);
        EXPECT_LE(share_over(kept, exact, 0.1f), share_over(fresh, exact, 0.1f) + 0.02) << second;
        if (second == 0) continue;
        kept_rays += stage.statistics().gather_rays - kept_before;
        new_rays += anew.statistics().gather_rays - new_before;
    }
    EXPECT_LT(10 * kept_rays, 9 * new_rays);
}

TEST(LightChange, OfAThingThatMovesIsFollowedSlow) {
    expect_light_follows(move_box);
}

TEST(LightChange, OfALampThatFadesIsFollowedSlow) {
    expect_light_follows(fade_lamp);
}

/// A room that its only lamp lights, which fades to a half.
test::SceneBuilder fading_room() {
    test::SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 4}, b.add_material(glm::vec3(0.6f)), true);
    b.add_box({1, 0, 1}, {2, 1, 2}, b.add_material({0.7f, 0.3f, 0.2f}));
    b.add_point_light({2.5f, 2.4f, 2.5f}, 3.0f);
    b.add_camera({3.2f, 1.5f, 3.8f}, {1.5f, 0.6f, 1.2f}, 1.1f);
    b.add_track(scene::TrackTarget::light_intensity, 0, 1, {0, 1}, {1, 0.5f});
    return b;
}

TEST(LightChange, OfTheOnlyLampIsAFactor) {
    FilmStage stage(fading_room(), by_rays(CacheUse::on));
    const core::Radiance before = stage.cut(0.1f, 0);
    const std::uint64_t created = stage.statistics().cache.created;
    core::Radiance half = before;
    for (glm::vec3& p : half.combined.values()) p *= 0.5f;
    const core::Radiance now = stage.cut(0.1f, 1);
    // Cells are asked at other places than before, and err otherwise.
    EXPECT_LE(share_over(now, half, 0.05f), 0.03);
    EXPECT_LE(stage.statistics().cache.created - created, created / 5) << "records stay";
}

TEST(LightChange, ToDarknessLeavesNoGhost) {
    test::SceneBuilder b = fading_room();
    b.add_track(scene::TrackTarget::light_intensity, 0, 1, {0, 1}, {1, 0});
    FilmStage stage(b, by_rays(CacheUse::on));
    const core::Radiance lit = stage.cut(0.1f, 0), dark = stage.cut(0.1f, 1);
    const auto brightest = [](const core::Radiance& r) {
        float most = 0;
        for (const glm::vec3& p : r.combined.values()) most = std::max(most, p.x);
        return most;
    };
    EXPECT_GT(brightest(lit), 0.01f);
    EXPECT_LE(brightest(dark), 1e-6f * brightest(lit));
}

TEST(LightChange, FollowsASmallThingOnASinglePixel) {
    // Wherever its only records lie, on even pixels or not.
    for (int shift = 0; shift < 4; ++shift) {
        test::SceneBuilder b;
        b.add_box({0.0f, 0.0f, 0.0f}, {0.06f, 0.06f, 0.06f}, b.add_material(glm::vec3(0.8f)));
        b.film().sky.color = {1, 1, 1};
        const float x = 0.06f * static_cast<float>(shift % 2), y = 0.06f * static_cast<float>(shift / 2);
        b.add_camera({x, y, 2.0f}, {x, y, 0}, 1.0f);
        b.move_object(b.add_box({5, 5, 5}, {6, 6, 6}, b.add_material(glm::vec3(0.5f))), {{0, 0, 0}, {0.5f, 0, 0}});
        FilmStage stage(b, by_rays(CacheUse::on));
        const core::Radiance before = stage.cut(0.1f, 0), now = stage.cut(0.1f, 1);
        EXPECT_LE(share_over(now, before, 0.1f), 0.0) << shift;
    }
}

TEST(LightChange, RecordsGoWithWhatMoves) {
    test::SceneBuilder b = room();
    b.move_object(b.add_box({0.2f, 0.0f, 2.0f}, {1.4f, 1.2f, 2.4f}, b.add_material(glm::vec3(0.7f))),
                  {{0, 0, 0}, {0.02f, 0, 0.01f}});
    FilmStage stage(b, by_rays(CacheUse::on));
    stage.cut(0.1f, 0);
    const std::uint64_t created = stage.statistics().cache.created;
    ASSERT_GT(created, 200u);
    stage.cut(0.1f, 1);
    EXPECT_LT(stage.statistics().cache.created - created, created / 2);
}

TEST(LightChange, LeavesTheLightOfSunsThatHaveASize) {
    test::SceneBuilder b;
    b.add_quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, b.add_material(glm::vec3(0.5f)));
    b.film().lights[static_cast<std::size_t>(b.add_sun({0.3f, -1, 0.2f}, 3.0f))].angle = 0.05f;
    b.film().sky.color = glm::vec3(0.2f);
    b.move_object(b.add_box({1.4f, 0.1f, 1.4f}, {1.6f, 0.3f, 1.6f}, b.add_material()), {{0, 0, 0}, {0.02f, 0, 0}});
    b.add_camera({0, 3, 0.1f}, {0, 0, 0});
    FilmStage stage(b, by_rays(CacheUse::on));
    const core::Radiance before = stage.cut(0.05f, 0), now = stage.cut(0.05f, 1);
    EXPECT_LE(share_over(now, before, 0.1f), 0.02);
}

TEST(LightChange, OfNothingIsNone) {
    test::SceneBuilder b = room();
    fade_lamp(b);
    const scene::Animation film = b.build();
    const auto at = [&](int second) { return snapshot_of(film, second); };
    EXPECT_TRUE(change_between(at(1), at(1)).none());
    EXPECT_FALSE(change_between(at(1), at(2)).none());
    EXPECT_TRUE(change_between(at(1), at(2)).sources);
    EXPECT_FALSE(change_between(at(1), at(2)).things);
}

}  // namespace
}  // namespace render2mpeg::renderer
