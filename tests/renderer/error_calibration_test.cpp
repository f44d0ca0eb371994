#include "renderer/calibration/error_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/calibration/calibration.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;

/// Pixels whose errors over their tolerance are `error` of uniform numbers.
std::vector<AuditedPixel> pixels_of(int count, std::uint64_t seed, const std::function<float(float)>& error) {
    std::vector<AuditedPixel> pixels;
    for (int i = 0; i < count; ++i) {
        AuditedPixel p;
        p.luminance = 1.0f;
        p.tolerance = 0.02f;
        p.error = p.tolerance * error(core::uniform(seed, static_cast<std::uint64_t>(i)));
        pixels.push_back(p);
    }
    return pixels;
}

TEST(ErrorCalibration, IsTheLawsOwnWhileLittleIsKnown) {
    ErrorCalibration calibration;
    EXPECT_EQ(calibration.value(), 1.0f);
    calibration.learn(pixels_of(ErrorCalibration::least_pixels - 1, 1, [](float) { return 0.2f; }), 1.0f);
    EXPECT_EQ(calibration.value(), 1.0f);
    calibration.learn(pixels_of(1, 1, [](float) { return 0.2f; }), 1.0f);
    EXPECT_NEAR(calibration.value(), 0.3f, 0.3f * 0.016f);  // half as much again for so few; in steps
    calibration.forget();
    EXPECT_EQ(calibration.value(), 1.0f);
}

TEST(ErrorCalibration, KeepsThePromiseForNewPixelsWhateverTheirErrors) {
    const std::function<float(float)> shapes[] = {
        [](float u) { return 0.5f * u; },                                      // even
        [](float u) { return -0.1f * std::log(1.0f - u); },                    // exponential
        [](float u) { return 0.05f * std::pow(1.0f - u, -0.4f); },             // heavy tail
        [](float u) { return u < 0.97f ? 0.1f : 0.5f + 10.0f * (u - 0.97f); }  // a few of another kind
    };
    for (const auto& shape : shapes) {
        double over = 0, pixels = 0, error_scales = 0;
        for (std::uint64_t film = 0; film < 100; ++film) {
            ErrorCalibration calibration;
            calibration.learn(pixels_of(400, 2 * film, shape), 1.0f);
            error_scales += static_cast<double>(calibration.value());
            // Errors at the error scale found are those at 1 over it.
            for (const AuditedPixel& p : pixels_of(1000, 2 * film + 1, shape)) {
                over += p.noticed() > calibration.value() * p.tolerance ? 1 : 0;
                pixels += 1;
            }
        }
        EXPECT_LT(over / pixels, 0.01);
        // More would be waste.
        EXPECT_LT(error_scales / 100, 1.8 * static_cast<double>(shape(0.99f)));
    }
}

TEST(ErrorCalibration, ScattersLessThanTheLargestOfFewPixels) {
    const auto error = [](float u) { return -0.1f * std::log(1.0f - u); };
    double sums[2] = {}, squares[2] = {};
    constexpr int films = 200;
    for (std::uint64_t film = 0; film < films; ++film) {
        const auto pixels = pixels_of(256, film, error);
        ErrorCalibration calibration;
        calibration.learn(pixels, 1.0f);
        float largest = 0;
        for (const AuditedPixel& p : pixels) largest = std::max(largest, p.noticed() / p.tolerance);
        const double logs[] = {std::log(calibration.value()), std::log(largest)};
        for (int i = 0; i < 2; ++i) {
            sums[i] += logs[i];
            squares[i] += logs[i] * logs[i];
        }
    }
    const auto deviation = [&](int i) { return std::sqrt(squares[i] / films - sums[i] / films * (sums[i] / films)); };
    EXPECT_LT(deviation(0), 0.75 * deviation(1));
    // What half a hundredth exceeds, and a fourth for so few.
    EXPECT_NEAR(std::exp(sums[0] / films), 1.25 * -0.1 * std::log(0.005), 0.05);
}

TEST(ErrorCalibration, IsNotDecidedByOneFault) {
    ErrorCalibration calibration;
    auto pixels = pixels_of(500, 1, [](float u) { return 0.5f * u; });
    calibration.learn(pixels, 1.0f);
    const float before = calibration.value();
    pixels[100].error = 1e6f;
    calibration.forget();
    calibration.learn(pixels, 1.0f);
    EXPECT_GT(calibration.value(), before);
    EXPECT_LT(calibration.value(), 1.5f * before);
}

TEST(ErrorCalibration, IsToldInTheMeasureOfTheErrorScaleThatPixelsWereLitWith) {
    ErrorCalibration at_one, at_half;
    at_one.learn(pixels_of(300, 1, [](float u) { return 0.6f * u; }), 1.0f);
    at_half.learn(pixels_of(300, 1, [](float u) { return 1.2f * u; }), 0.5f);
    EXPECT_NEAR(at_one.value(), at_half.value(), 1e-5f);
}

TEST(ErrorCalibration, IsHeldWhileWhatIsLearntScatters) {
    // Frame after frame of the same light, audited by other dice.
    ErrorCalibration calibration;
    const auto error = [](float u) { return -0.1f * std::log(1.0f - u); };
    calibration.learn(pixels_of(2048, 1, error), 1.0f);
    int changes = 0;
    for (std::uint64_t frame = 0; frame < 300; ++frame) {
        const float before = calibration.value();
        calibration.learn(pixels_of(32, 2 + frame, error), calibration.value());
        changes += calibration.value() != before ? 1 : 0;
        // A step is large enough to be worth it.
        if (calibration.value() != before) {
            EXPECT_GT(std::abs(std::log(calibration.value() / before)), 0.05f);
        }
    }
    EXPECT_LE(changes, 8);
    // Let go, what is known counts again, in steps of 3 %.
    calibration.settle();
    const float step = std::log(calibration.value()) / std::log(1.03f);
    EXPECT_NEAR(step, std::round(step), 1e-3f);
}

TEST(ErrorCalibration, RisesWithTheFirstPixelsOfAnotherLightAndForgetsItInTime) {
    ErrorCalibration calibration;
    calibration.learn(pixels_of(1000, 1, [](float u) { return 0.3f * u; }), 1.0f);
    const float before = calibration.value();
    calibration.learn(pixels_of(64, 2, [](float u) { return u < 0.7f ? 0.3f * u : 1.5f; }), 1.0f);
    EXPECT_GT(calibration.value(), 1.5f);
    EXPECT_LT(calibration.value(), 1.65f);
    for (std::uint64_t i = 0; i < 100; ++i)
        calibration.learn(pixels_of(64, 3 + i, [](float u) { return 0.3f * u; }), 1.0f);
    EXPECT_NEAR(calibration.value(), before, 0.01f);
}

TEST(ErrorCalibration, TakesNoLessonFromPixelsThatNothingWasPromisedOf) {
    ErrorCalibration calibration;
    auto pixels = pixels_of(1000, 1, [](float u) { return u < 0.5f ? 100.0f : 0.2f; });
    for (AuditedPixel& p : pixels) p.capped = p.error > p.tolerance;
    calibration.learn(pixels, 1.0f);
    EXPECT_NEAR(calibration.value(), 0.2f, 0.03f);
    // Black ones, too: the light may come on.
    calibration.forget();
    pixels.assign(1000, {});
    calibration.learn(pixels, 1.0f);
    EXPECT_EQ(calibration.pixels(), 0u);
    EXPECT_EQ(calibration.value(), 1.0f);
}

TEST(ErrorCalibration, CountsColour) {
    ErrorCalibration calibration;
    auto pixels = pixels_of(500, 1, [](float) { return 0.1f; });
    for (AuditedPixel& p : pixels) p.chroma = p.tolerance;
    calibration.learn(pixels, 1.0f);
    EXPECT_GT(calibration.value(), 0.5f);
    EXPECT_LT(calibration.value(), 0.58f);
}

TEST(ErrorCalibration, StaysWithinItsBounds) {
    ErrorCalibration calibration;
    calibration.learn(pixels_of(500, 1, [](float) { return 1e30f; }), 1.0f);
    EXPECT_LE(calibration.value(), 5.0f);
    calibration.forget();
    calibration.learn(pixels_of(500, 1, [](float) { return 0.0f; }), 1.0f);
    EXPECT_GE(calibration.value(), 0.05f);
    EXPECT_LT(calibration.value(), 1.0f);
}

/// The least side of a frame that is calibrated.
constexpr int picture_side = 96;

Settings room_settings(bool calibrate) {
    Settings settings = test::lightcuts_frame(picture_side, picture_side);
    settings.vpls = 1000;
    settings.direct_points = 128;
    settings.max_cut = 1 << 20;
    settings.calibrate = calibrate;
    return settings;
}

TEST(CalibrationSlow, KeepsThePromiseOfARoomWithFarFewerRays) {
    FilmStage lawful(test::furnished_room(), room_settings(false)), own(test::furnished_room(), room_settings(true));
    const core::Radiance truth = lawful.reference();
    for (const float tolerance : {0.02f, 0.08f}) {
        own.renderer().start_chunk(own.at(0));
        const std::uint64_t rays[] = {own.statistics().shadow_rays, lawful.statistics().shadow_rays};
        EXPECT_LE(test::share_over(own.cut(tolerance), truth, tolerance), 0.01);
        lawful.cut(tolerance);
        const double ratio = static_cast<double>(own.statistics().shadow_rays - rays[0]) /
                             static_cast<double>(lawful.statistics().shadow_rays - rays[1]);
        // The rays to the panel are the same; one pixel of those drawn that needs all keeps the scale near 1.
        EXPECT_LT(ratio, 1.0) << tolerance;
        EXPECT_GT(ratio, 0.1) << tolerance;
    }
    const Statistics& s = own.statistics();
    EXPECT_LT(s.least_error_scale, 0.8);
    EXPECT_LT(s.largest_error_scale, 1.0);
    EXPECT_GT(s.least_error_scale, 0.1);
    EXPECT_GE(s.mean_error_scale, s.least_error_scale);
    EXPECT_LE(s.mean_error_scale, s.largest_error_scale);
    // Two chunks of two rounds, each with pixels of its own.
    EXPECT_GT(s.calibrated_pixels, 4 * ErrorCalibration::least_pixels);
    EXPECT_LT(s.calibrated_pixels, 5 * ErrorCalibration::least_pixels);
}

TEST(Calibration, IsTheSameForAnyNumberOfThreadsSlow) {
    core::Radiance frames[2][2];
    double error_scales[2];
    for (int threads : {1, 2}) {
        const parallel::ThreadLimit limit(threads);
        Settings settings = room_settings(true);
        settings.vpls = 200;
        FilmStage stage(test::furnished_room(), settings);
        for (int i = 0; i < 2; ++i) frames[threads - 1][i] = stage.cut(0.2f, i);
        error_scales[threads - 1] = stage.statistics().mean_error_scale;
    }
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(test::same_bytes(frames[0][i], frames[1][i]));
    EXPECT_EQ(error_scales[0], error_scales[1]);
    EXPECT_NE(error_scales[0], 1.0);
}

TEST(Calibration, StillFilmsStayAsTheyAreToTheLastBitSlow) {
    Settings settings = room_settings(true);
    settings.vpls = 200;
    FilmStage stage(test::furnished_room(), settings);
    const core::Radiance first = stage.cut(0.2f, 0);
    const Statistics after_one = stage.statistics();
    for (int i = 1; i < 6; ++i) EXPECT_TRUE(test::same_bytes(first, stage.cut(0.2f, i))) << i;
    EXPECT_EQ(stage.statistics().calibrated_pixels, after_one.calibrated_pixels);
    EXPECT_NE(stage.statistics().mean_error_scale, 1.0);
    // Another tolerance is learnt from.
    stage.cut(0.1f, 6);
    EXPECT_GT(stage.statistics().calibrated_pixels, after_one.calibrated_pixels);
}

TEST(Calibration, LearnsOfCoarserTolerancesAsWellSlow) {
    Settings settings = room_settings(true);
    settings.vpls = 200;
    FilmStage stage(test::furnished_room(), settings);
    const auto learnt = [&](float tolerance, int frame) {
        const std::uint64_t before = stage.statistics().calibrated_pixels;
        stage.cut(tolerance, frame);
        return stage.statistics().calibrated_pixels - before;
    };
    const std::uint64_t first = learnt(0.05f, 0);
    // Half as many, and what every frame teaches: 64 pixels at most.
    const std::uint64_t coarser = learnt(0.2f, 1);
    EXPECT_GE(coarser, first / 2);
    EXPECT_LE(coarser, first / 2 + 64);
    EXPECT_LE(learnt(0.25f, 2), 64u);
    EXPECT_LE(learnt(0.05f, 3), 64u);
    EXPECT_LE(learnt(0.2f, 4), 64u);
    stage.renderer().start_chunk(stage.at(0));
    EXPECT_GE(learnt(0.05f, 0), first);
}

TEST(Calibration, TypicalSharesAreOfPixelsThatGatherLight) {
    FilmStage stage(test::furnished_room(), room_settings(true));
    const Frame seen = stage.renderer().look(stage.at(0));
    core::ToleranceMap map = core::ToleranceMap::uniform(picture_side, picture_side, {0.0f, 0.02f});
    EXPECT_NEAR(typical_share(seen, map), 0.02f, 1e-6f);
    // Half of them told of a tenth of their light, one in eight of all of it.
    for (int y = 0; y < picture_side; ++y)
        for (int x = 0; x < picture_side; ++x)
            map.pixels.at(x, y) = {y % 8 == 0 ? 1.0f : x % 2 == 0 ? 0.1f : 0.0f, 0.001f, y % 8 == 0 ? 0.5f : 1.0f};
    EXPECT_NEAR(typical_share(seen, map), std::sqrt(0.1f * 0.001f), 0.002f);
    EXPECT_EQ(typical_share(seen, core::ToleranceMap::uniform(picture_side, picture_side, {1.0f, 0.0f, 0.5f})), 0.0f);
    Frame nothing = seen;
    for (GatherTile& tile : nothing.tiles) tile.clear();
    EXPECT_EQ(typical_share(nothing, map), 0.0f);
}

TEST(Calibration, LeavesSmallFramesAlone) {
    FilmStage small(test::furnished_room(), test::lightcuts_frame(40, 40));
    small.cut(0.1f);
    EXPECT_EQ(small.statistics().mean_error_scale, 1.0);
}

TEST(Calibration, BeginsAnewWithEachChunkAndTeachesNothingByRoughLooksSlow) {
    Settings settings = room_settings(true);
    settings.vpls = 200;
    FilmStage stage(test::furnished_room(), settings);
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    const auto map = core::ToleranceMap::uniform(picture_side, picture_side, {0.0f, 0.2f});
    const core::Radiance first = stage.renderer().light(world, seen, {map}).radiance;
    stage.renderer().start_chunk(world);
    const Statistics before = stage.statistics();
    stage.renderer().light(world, seen, {map, LightingMode::rough}).radiance;
    EXPECT_EQ(stage.statistics().gather_points, before.gather_points);
    EXPECT_EQ(stage.statistics().shadow_rays, before.shadow_rays);
    EXPECT_EQ(stage.statistics().direct_clusters, before.direct_clusters);
    EXPECT_TRUE(test::same_bytes(first, stage.renderer().light(world, seen, {map}).radiance));
}

}  // namespace
}  // namespace render2mpeg::renderer
