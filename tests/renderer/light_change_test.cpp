// Light that changes from frame to frame: rays that are kept find what new ones would.
#include "renderer/geometry/light_change.h"

#include <gtest/gtest.h>

#include "core/sampling.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::share_over;
constexpr int side = 32;

Settings by_rays(CacheUse cache) {
    Settings s = test::small_frame(side, side);
    s.indirect = Indirect::rays;
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

/// Frames 1 to 3 keep their tolerance as well as frames that know nothing do, for less of their rays.
void expect_light_follows(void (*change)(test::SceneBuilder&)) {
    test::SceneBuilder b = room();
    change(b);
    FilmStage stage(b, by_rays(CacheUse::on)), anew(b, by_rays(CacheUse::on)), truth(b, by_rays(CacheUse::off));
    std::uint64_t kept_rays = 0, new_rays = 0;
    for (int second = 0; second < 4; ++second) {
        const core::Radiance exact = truth.cut(0.005f, second);
        anew.renderer().start_chunk(anew.at(second));
        const std::uint64_t kept_before = stage.statistics().gather_rays, new_before = anew.statistics().gather_rays;
        const core::Radiance kept = stage.cut(0.05f, second), fresh = anew.cut(0.05f, second);
        EXPECT_LE(share_over(kept, exact, 0.1f), share_over(fresh, exact, 0.1f) + 0.02) << second;
        if (second == 0) continue;
        kept_rays += stage.statistics().gather_rays - kept_before;
        new_rays += anew.statistics().gather_rays - new_before;
    }
    EXPECT_LT(4 * kept_rays, 3 * new_rays);
}

TEST(LightChange, OfAThingThatMovesIsFollowedSlow) {
    expect_light_follows(move_box);
}

TEST(LightChange, OfALampThatFadesIsFollowedSlow) {
    expect_light_follows(fade_lamp);
}

TEST(LightChange, IsMetByEveryRayThatFindsSomethingElse) {
    test::SceneBuilder b = room();
    move_box(b);
    test::Stage before(b, side, side, 0), now(b, side, side, 1);
    const LightChange change = change_between(before.world(), snapshot_of(before.film(), 1));
    ASSERT_FALSE(change.all);
    ASSERT_FALSE(change.boxes.empty());
    const glm::vec3 origin{1.2f, 1.0f, 2.8f};
    const SeenChange seen(change, origin);
    int others = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        const core::PackedNormal direction(core::sample_sphere({core::halton(0, i + 1), core::halton(1, i + 1)}));
        const Hit then = before.tracer().nearest(origin, direction.unpack(), 100.0f),
                  hit = now.tracer().nearest(origin, direction.unpack(), 100.0f);
        if (then.address == hit.address) continue;
        ++others;
        EXPECT_TRUE(seen.meets(direction, then.found() ? then.distance : 1e30f)) << i;
    }
    EXPECT_GT(others, 20);
}

TEST(LightChange, OfNothingIsNone) {
    test::SceneBuilder b = room();
    fade_lamp(b);
    const scene::Animation film = b.build();
    const auto at = [&](int second) { return snapshot_of(film, second); };
    EXPECT_TRUE(change_between(at(1), at(1)).none());
    EXPECT_FALSE(change_between(at(1), at(2)).none());
    EXPECT_TRUE(change_between(at(1), at(2)).changes_sources(film));
    EXPECT_FALSE(change_between(at(1), at(2)).moves_sources(film));
    EXPECT_TRUE(change_between(at(1), at(2)).boxes.empty());
}

}  // namespace
}  // namespace render2mpeg::renderer
