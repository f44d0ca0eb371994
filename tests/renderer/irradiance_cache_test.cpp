#include "renderer/cache/irradiance_cache.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::share_over;
constexpr int cache_size = 48;

Settings cache_settings(bool cache) {
    Settings s = test::lightcuts_frame(cache_size, cache_size);
    s.cache = cache ? CacheUse::on : CacheUse::off;
    return s;
}

/// The furnished room from a camera that walks sideways, with a lamp that shines for itself.
test::SceneBuilder walk(bool moves = true) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    if (moves)
        b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 10},
                    {2.0f, 1.6f, 3.8f, 2.4f, 1.6f, 3.8f});
    return b;
}

TEST(IrradianceCache, LightsAWalkWithinItsToleranceForAFractionOfTheRaysSlow) {
    FilmStage plain(walk(), cache_settings(false)), cached(walk(), cache_settings(true));
    double over = 0;
    std::uint64_t rays = 0, all = 0;
    for (int second = 0; second < 3; ++second) {
        const std::uint64_t before = cached.statistics().shadow_rays, plain_before = plain.statistics().shadow_rays;
        const core::Radiance frame = cached.cut(0.05f, second);
        const core::Radiance cut = plain.cut(0.05f, second);
        if (second > 0) {
            rays += cached.statistics().shadow_rays - before;
            all += plain.statistics().shadow_rays - plain_before;
        }
        over += share_over(frame, plain.reference(second), 0.05f) / 3;
    }
    EXPECT_LE(over, 0.02);
    EXPECT_LE(rays, all * 6 / 10);
    EXPECT_GT(rays, all / 50);
}

TEST(IrradianceCache, AStillFilmShootsNoSecondShadowRayAndStaysStill) {
    FilmStage stage(walk(false), cache_settings(true));
    const core::Radiance first = stage.cut(0.05f, 0);
    const std::uint64_t rays = stage.statistics().shadow_rays;
    EXPECT_GT(rays, 0u);
    for (int second = 1; second < 4; ++second) EXPECT_TRUE(test::same_bytes(first, stage.cut(0.05f, second)));
    EXPECT_EQ(stage.statistics().shadow_rays, rays);
    // A finer tolerance is another matter, but not for all.
    stage.cut(0.02f, 4);
    const std::uint64_t more = stage.statistics().shadow_rays - rays;
    EXPECT_GT(more, 0u);
}

TEST(IrradianceCache, AFinerToleranceGoesOnWithTheRecordsInItsPlacesSlow) {
    Settings s = cache_settings(true);
    s.indirect = Indirect::rays;
    FilmStage stage(walk(false), s);
    stage.cut(0.1f, 0);
    const Statistics coarse = stage.statistics();
    stage.cut(0.02f, 1);
    const Statistics fine = stage.statistics();
    EXPECT_GT(fine.gather_rays - coarse.gather_rays, coarse.gather_rays) << "it takes more rays";
    EXPECT_LE(fine.cache.created, coarse.gather_points) << "no place has two records";
    EXPECT_GT(2 * fine.cache.created, coarse.gather_points) << "and most have one";
}

TEST(IrradianceCache, PointsSeenInAMirrorShareTheirRaysSlow) {
    test::SceneBuilder b = walk(false);
    const int mirror = b.add_material({1, 1, 1});
    b.material(mirror).metallic = 1;
    b.material(mirror).roughness = 0;
    b.add_quad({1.0f, 0.6f, 3.0f}, {2.0f, 0, 0}, {0, 2.0f, 0}, mirror);
    Settings s = cache_settings(false);
    s.indirect = Indirect::rays;
    FilmStage alone(b, s);
    s.cache = CacheUse::on;
    FilmStage shared(b, s);
    const core::Radiance own = alone.cut(0.02f), light = shared.cut(0.02f), truth = alone.reference();
    // The mirror fills the picture.
    double off = 0, off_alone = 0;
    for (std::size_t i = 0; i < truth.combined.values().size(); ++i) {
        const float seen = core::luminance(truth.combined.values()[i]);
        ASSERT_GT(seen, 0.0f);
        off += std::pow(core::luminance(light.combined.values()[i]) / seen - 1, 2);
        off_alone += std::pow(core::luminance(own.combined.values()[i]) / seen - 1, 2);
    }
    // Errors that points share are few: by seven other sets of rays it is 1.1 to 1.9.
    EXPECT_LT(off, 2.5 * off_alone);
    EXPECT_LT(std::sqrt(off / (cache_size * cache_size)), 0.02);
    EXPECT_LT(2 * shared.statistics().gather_rays, alone.statistics().gather_rays);
}

TEST(IrradianceCache, IsTheSameForAnyNumberOfThreadsSlow) {
    // Six areas whose records meet, two samples a pixel.
    Settings s = cache_settings(true);
    s.format = {136, 80, 1.0f};
    s.samples = 2;
    s.direct_points = 32;
    s.vpls = 50;
    for (const Indirect indirect : {Indirect::lightcuts, Indirect::rays}) {
        s.indirect = indirect;
        FilmStage one(walk(), s), two(walk(), s);
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
        EXPECT_EQ(one.statistics().cache.created, two.statistics().cache.created);
        EXPECT_EQ(one.statistics().cache.served, two.statistics().cache.served);
        EXPECT_GT(one.statistics().cache.served, 0u);
    }
}

TEST(IrradianceCache, StartsAnewWithAChunkSlow) {
    FilmStage long_run(walk(), cache_settings(true)), fresh(walk(), cache_settings(true));
    long_run.cut(0.05f, 0);
    long_run.cut(0.05f, 1);
    long_run.renderer().start_chunk(long_run.at(2));
    fresh.renderer().start_chunk(fresh.at(2));
    EXPECT_TRUE(test::same_bytes(long_run.cut(0.05f, 2), fresh.cut(0.05f, 2)));
}

TEST(IrradianceCache, ForgetsWhatItKnewWhenALampIsDimmedOrAPanelDoubledSlow) {
    test::SceneBuilder b = walk(false);
    const int panel = 1;  // of furnished_room's materials
    b.add_track(scene::TrackTarget::light_intensity, 0, 1, {0, 1, 2, 3}, {6.0f, 6.0f, 0.6f, 0.6f});
    b.add_track(scene::TrackTarget::emission, panel, 1, {0, 2, 3}, {1, 1, 2});
    FilmStage stage(b, cache_settings(true)), plain(b, cache_settings(false));
    core::Radiance before = stage.cut(0.05f, 0);
    for (const int second : {2, 3}) {
        const core::Radiance truth = plain.reference(second);
        ASSERT_GE(share_over(before, truth, 0.05f), 0.5) << "the change counts";
        before = stage.cut(0.05f, second);
        EXPECT_LE(share_over(before, truth, 0.05f), 0.02);
        EXPECT_GT(stage.statistics().cache.served, 0u) << "within the frame";
    }
}

TEST(IrradianceCache, ShowsNoShadowOfWhatIsGoneSlow) {
    test::SceneBuilder b = walk(false);
    const int box = b.add_box({0.3f, 0.0f, 2.2f}, {0.9f, 0.5f, 2.8f}, b.add_material({0.5f, 0.5f, 0.5f}));
    b.move_object(box, {{0, 0, 0}, {0, 0, 0}, {0, -9, 0}});
    FilmStage stage(b, cache_settings(true)), plain(b, cache_settings(false));
    stage.cut(0.05f, 0);
    const core::Radiance truth = plain.reference(2);
    ASSERT_GE(share_over(stage.cut(0.05f, 1), truth, 0.05f), 0.04) << "the box and its shadow count";
    EXPECT_LE(share_over(stage.cut(0.05f, 2), truth, 0.05f), 0.02);
}

TEST(IrradianceCache, TellsOfEveryPixelHowOldItsLightIs) {
    Settings s = cache_settings(true);
    s.samples = 2;
    FilmStage stage(walk(false), s), plain(walk(false), cache_settings(false));
    plain.restart(true);
    for (int second = 0; second < 2; ++second) {
        const core::Radiance gathered = plain.cut(0.05f, second);
        for (const float reused : gathered.record_reuse.values()) ASSERT_EQ(reused, 0.0f) << "there is no cache";
    }
    stage.restart(true);
    for (int second = 0; second < 3; ++second) {
        const core::Radiance frame = stage.cut(0.05f, second);
        ASSERT_EQ(frame.record_age.size(), frame.combined.size());
        double reuse = 0, records = 0;
        for (std::size_t i = 0; i < frame.combined.size(); ++i) {
            // A still film's light is all of its first frame, whoever it was gathered for.
            EXPECT_EQ(frame.record_age.values()[i], static_cast<float>(second));
            reuse += frame.record_reuse.values()[i] / static_cast<double>(frame.combined.size());
            records += frame.record_density.values()[i];
        }
        if (second == 0) {
            const renderer::Statistics& counts = stage.statistics();
            // Pixels count alike, whether they show one surface or two.
            EXPECT_NEAR(reuse, static_cast<double>(counts.cache.served) / static_cast<double>(counts.gather_points),
                        0.04);
            EXPECT_GT(reuse, 0.1);
            EXPECT_LT(reuse, 0.95);
        } else {
            EXPECT_NEAR(reuse, 1.0, 1e-6);
        }
        EXPECT_NEAR(records, static_cast<double>(stage.statistics().cache.live), 0.01 * records);
        EXPECT_GT(records, 100.0);
    }
}

/// Lights each of the seconds and measures the last one's errors over its pixels' luminance.
struct Errors {
    double beyond = 0, mean = 0, age = 0;
};
Errors errors_after(FilmStage& stage, int first, int last) {
    core::Radiance frame;
    for (int second = first; second <= last; ++second) frame = stage.cut(0.05f, second);
    Errors errors{stage.share_beyond(frame, 0.05f, last)};
    const core::Radiance truth = stage.reference(last);
    const auto count = static_cast<double>(frame.combined.size());
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        const double expected = core::luminance(truth.combined.values()[i]);
        errors.mean += std::abs(core::luminance(frame.combined.values()[i]) - expected) / expected / count;
        errors.age += frame.record_age.values()[i] / count;
    }
    return errors;
}

TEST(IrradianceCacheSlow, RecordsOfAgeFortyErrAtMostAQuarterMoreThanThoseOfAgeOne) {
    test::SceneBuilder b = walk(false);
    b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 47},
                {2.0f, 1.6f, 3.8f, 2.15f, 1.6f, 3.8f});
    FilmStage long_run(b, cache_settings(true)), short_run(b, cache_settings(true));
    long_run.restart(true);
    short_run.restart(true);
    const Errors old = errors_after(long_run, 0, 47), young = errors_after(short_run, 46, 47);
    EXPECT_GE(old.age, 25.0) << "most of what is seen was gathered long ago";
    EXPECT_LE(young.age, 1.0);
    EXPECT_LE(old.beyond, young.beyond + 0.01);
    EXPECT_LE(old.mean, 1.25 * young.mean);
    EXPECT_GT(old.mean, 0.3 * young.mean);
}

TEST(IrradianceCache, CountsWhatIsCappedForServedPointsToo) {
    Settings s = cache_settings(true);
    s.max_cut = 24;
    FilmStage stage(walk(false), s);
    stage.cut(0.03f, 0);
    const std::uint64_t once = stage.statistics().capped_points;
    EXPECT_GT(once, 0u);
    stage.cut(0.03f, 1);
    EXPECT_EQ(stage.statistics().capped_points, 2 * once);
}

TEST(IrradianceCache, TellsTheShareOfClampedLightAsCutsDoSlow) {
    FilmStage plain(walk(), cache_settings(false)), cached(walk(), cache_settings(true));
    for (int second = 0; second < 3; ++second) {
        plain.cut(0.08f, second);
        cached.cut(0.08f, second);
    }
    ASSERT_GT(cached.statistics().cache.served, cached.statistics().gather_points / 3);
    const double clamped = plain.statistics().clamped_energy;
    EXPECT_GT(clamped, 0.0);
    // What is not put back of it is a small difference.
    EXPECT_NEAR(cached.statistics().clamped_energy, clamped, 0.4 * clamped);
}

TEST(IrradianceCache, ACutKeepsRecordsButNoPointsLight) {
    // The second camera is a twin of the first, so that only the cut tells them apart.
    test::SceneBuilder b = walk(false);
    b.add_camera({2.0f, 1.6f, 3.8f}, {2.0f, 1.0f, 0.0f}, 1.1f);
    b.film().shots = {{0, 0}, {1, 1}};
    FilmStage stage(b, cache_settings(true));
    ASSERT_TRUE(stage.at(1).cut_before);
    stage.cut(0.05f, 0);
    const std::uint64_t rays = stage.statistics().shadow_rays;
    const core::Radiance after = stage.cut(0.05f, 1);
    const std::uint64_t more = stage.statistics().shadow_rays - rays;
    EXPECT_GT(more, 0u);
    EXPECT_LT(more, rays);
    EXPECT_LE(share_over(after, stage.reference(1), 0.05f), 0.02);
}

TEST(IrradianceCache, TakesNoPartInReferenceFramesSlow) {
    FilmStage plain(walk(), cache_settings(false)), cached(walk(), cache_settings(true));
    EXPECT_TRUE(test::same_bytes(plain.reference(0), cached.reference(0)));
    EXPECT_EQ(cached.statistics().cache.created, 0u);
}

TEST(IrradianceCache, LightsVarnishedWallsWithinTheirToleranceSlow) {
    test::SceneBuilder b = walk();
    const int matt = b.add_material({0.4f, 0.4f, 0.5f});
    b.material(matt).roughness = 0.8f;
    b.material(matt).ior = 1.5f;
    b.add_quad({0.1f, 0.5f, 0.1f}, {1.5f, 0, 0}, {0, 2, 0}, matt);
    const int polished = b.add_material({0.3f, 0.3f, 0.3f});
    b.material(polished).roughness = 0.3f;
    b.material(polished).ior = 1.5f;
    b.add_quad({2.4f, 0.5f, 0.1f}, {1.5f, 0, 0}, {0, 2, 0}, polished);
    FilmStage plain(b, cache_settings(false)), cached(b, cache_settings(true));
    for (int second = 0; second < 3; ++second) {
        const core::Radiance frame = cached.cut(0.05f, second);
        EXPECT_LE(cached.share_beyond(frame, 0.05f, second), 0.03) << second;
        EXPECT_LE(share_over(frame, plain.reference(second), 0.15f), 0.02) << second;
    }
}

TEST(IrradianceCache, LightsPolishedMetalForAFractionOfTheRaysSlow) {
    // All around the room.
    test::SceneBuilder b = walk();
    for (int m = 0; m < 4; ++m) {
        if (m == 1) continue;  // the panel
        b.material(m).metallic = 1.0f;
        b.material(m).roughness = 0.4f;
    }
    // The panel's light points are clustered: as an area lamp it would take next to no rays.
    b.material(1).alpha_mode = scene::AlphaMode::mask;
    FilmStage plain(b, cache_settings(false)), cached(b, cache_settings(true));
    double over = 0, plain_over = 0;
    std::uint64_t rays = 0, all = 0;
    for (int second = 0; second < 3; ++second) {
        const std::uint64_t before = cached.statistics().shadow_rays, plain_before = plain.statistics().shadow_rays;
        const core::Radiance frame = cached.cut(0.1f, second);
        const core::Radiance cut = plain.cut(0.1f, second);
        rays += cached.statistics().shadow_rays - before;
        all += plain.statistics().shadow_rays - plain_before;
        over += cached.share_beyond(frame, 0.1f, second) / 3;
        plain_over += share_over(cut, plain.reference(second), 0.1f) / 3;
    }
    EXPECT_LE(over, plain_over + 0.01);
    EXPECT_LE(rays, all * 9 / 10);
    EXPECT_GT(rays, all / 5);
}

}  // namespace
}  // namespace render2mpeg::renderer
