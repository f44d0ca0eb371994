#include "renderer/truth/pixel_truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sampling.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;
using test::Stage;

SeeSettings see_settings(int width, int height, int samples) {
    SeeSettings s;
    s.format = {width, height, 1.0f};
    s.samples = samples;
    return s;
}

/// The truth of the only pixel of a stage.
PixelTruth only_pixel(const SceneBuilder& builder, int samples = 4) {
    Stage stage(builder, 1, 1);
    const Frame seen = stage.see(samples);
    const TruthRequest request{{0, 0}, seen.tiles.front(), 1.0f};
    return pixel_truth(stage.posed_scene(), see_settings(1, 1, samples), stage.plan(), {&request, 1}).front();
}

TEST(PixelTruth, OfASkyIsTheSky) {
    SceneBuilder b;
    b.film().sky.color = {2, 1, 0.5f};
    b.add_quad({0, 0, -9}, {1, 0, 0}, {0, 1, 0}, b.add_material());  // behind
    b.add_camera({0, 0, 0}, {0, 0, 1});
    const PixelTruth t = only_pixel(b);
    for (const Estimate& e : {t.whole, t.at_points}) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.mean()[c], (glm::dvec3(2, 1, 0.5))[c], 1e-6);
        EXPECT_NEAR(e.variance, 0.0, 1e-12);
    }
}

TEST(PixelTruth, OfABlackSceneIsBlack) {
    SceneBuilder b;
    b.add_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, b.add_material());
    b.add_point_light({0, 0, -4}, 1);  // behind it
    b.add_camera({0, 0, 0}, {0, 0, -1});
    const PixelTruth t = only_pixel(b);
    EXPECT_EQ(t.whole.mean(), glm::dvec3(0));
    EXPECT_EQ(t.at_points.mean(), glm::dvec3(0));
    EXPECT_EQ(t.whole.variance, 0.0);
}

TEST(PixelTruth, IsThatOfTheWholePixel) {
    // An edge of what shines runs through the pixel, right of its middle, which one sample takes for all.
    SceneBuilder b;
    b.add_quad({-20, -20, -2}, {20.1f, 0, 0}, {0, 40, 0}, b.add_emitter(glm::vec3(1)));
    b.add_camera({0, 0, 0}, {0, 0, -1}, 0.5f);
    const PixelTruth t = only_pixel(b, 1);
    const double half_width = 2 * std::tan(0.25), covered = (half_width + 0.1) / (2 * half_width);
    EXPECT_NEAR(t.at_points.luminance(), 1.0, 1e-6);
    EXPECT_NEAR(t.whole.luminance(), covered, 4 * std::sqrt(t.whole.variance) + 1e-6);
    EXPECT_LT(std::sqrt(t.whole.variance), 0.02);
}

TEST(PixelTruth, OfAFurnaceIsAGeometricSum) {
    SceneBuilder b;
    const int wall = b.add_material(glm::vec3(0.5f));
    b.material(wall).emission = glm::vec3(1);
    b.add_box({-1, -1, -1}, {1, 1, 1}, wall, true);
    b.add_camera({0, 0, 0}, {0.3f, 0.2f, 1});
    const PixelTruth t = only_pixel(b);
    for (const Estimate& e : {t.whole, t.at_points}) {
        EXPECT_NEAR(e.luminance(), 2.0, 4 * std::sqrt(e.variance));
        EXPECT_LT(std::sqrt(e.variance), 0.02);
    }
}

TEST(PixelTruth, KnowsItsOwnErrorSlow) {
    const SceneBuilder room = test::furnished_room();
    Stage stage(room, 8, 8);
    const Frame seen = stage.see(4);
    std::vector<TruthRequest> requests;
    const GatherTile& tile = seen.tiles.front();
    for (std::size_t i = 0; i < tile.size(); ++i)
        if (i == 0 || tile[i].pixel != tile[i - 1].pixel)
            requests.push_back({{tile[i].pixel % tile_size, tile[i].pixel / tile_size}, std::span(&tile[i], 1), 1.0f});
    TruthSettings settings;
    settings.most_paths = 512;
    // How far estimates by other numbers lie apart is what each says of itself.
    double spread = 0, told = 0;
    std::vector<PixelTruth> one =
        pixel_truth(stage.posed_scene(), see_settings(8, 8, 4), stage.plan(), requests, settings);
    settings.seed = 2;
    std::vector<PixelTruth> two =
        pixel_truth(stage.posed_scene(), see_settings(8, 8, 4), stage.plan(), requests, settings);
    ASSERT_GT(one.size(), 40u);
    for (std::size_t i = 0; i < one.size(); ++i) {
        const double difference = one[i].whole.luminance() - two[i].whole.luminance();
        spread += difference * difference;
        told += one[i].whole.variance + two[i].whole.variance;
        EXPECT_EQ(one[i].paths, 512u);
    }
    EXPECT_GT(told, 0.0);
    EXPECT_NEAR(spread / told, 1.0, 0.6);
}

/// 20 code values for a luminance of 1.
double luma(glm::vec3 light) {
    return 20.0 * static_cast<double>(light.y);
}

/// A room, lit within a tolerance, and its audited pixels judged.
struct JudgedRoom {
    explicit JudgedRoom(float relative) : stage(test::furnished_room(), settings()), world(stage.at(0)) {
        tolerance =
            relative > 0 ? core::ToleranceMap::uniform(24, 24, {0.0f, relative}) : core::ToleranceMap::reference();
        lit = stage.renderer().light(world, stage.renderer().look(world), {tolerance});
    }
    static Settings settings() {
        Settings s = test::lightcuts_frame();
        s.samples = 4;
        return s;
    }
    std::vector<ValidatedPixel> judge(int count) {
        const auto audited = stage.renderer().audit(world, lit, tolerance, count);
        return stage.renderer().validate(world, lit, tolerance, audited);
    }
    FilmStage stage;
    scene::Snapshot world;
    core::ToleranceMap tolerance;
    Lit lit;
};

TEST(Judge, IsTheSameForAnyNumberOfThreadsAndCountsNowhereSlow) {
    JudgedRoom room(0.1f);
    const Statistics before = room.stage.statistics();
    std::vector<ValidatedPixel> one, two;
    {
        const parallel::ThreadLimit limit(1);
        one = room.judge(12);
    }
    {
        const parallel::ThreadLimit limit(2);
        two = room.judge(12);
    }
    ASSERT_EQ(one.size(), 12u);
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].truth.whole.halves, two[i].truth.whole.halves);
        EXPECT_EQ(one[i].truth.at_points.halves, two[i].truth.at_points.halves);
        EXPECT_EQ(one[i].truth.whole.variance, two[i].truth.whole.variance);
        EXPECT_EQ(one[i].truth.paths, two[i].truth.paths);
    }
    EXPECT_EQ(room.stage.statistics().shadow_rays, before.shadow_rays);
    EXPECT_EQ(room.stage.statistics().photon_rays, before.photon_rays);
    EXPECT_TRUE(room.judge(0).empty());
}

TEST(Judge, FindsGatheringWithoutErrorInAReferenceFrameSlow) {
    JudgedRoom room(0.0f);
    ErrorSplit split;
    split.add(room.judge(24), luma);
    EXPECT_EQ(split.pixels(), 24u);
    EXPECT_LT(split.rms(ErrorCause::gathering, ErrorMeasure::relative), 1e-4);
    // VPLs in a small room: some percent.
    EXPECT_LT(split.rms(ErrorCause::light_points, ErrorMeasure::relative), 0.1);
    EXPECT_LT(std::abs(split.bias(ErrorCause::total).value), 0.05);
    EXPECT_LT(split.bias(ErrorCause::total).error, 0.03);
}

TEST(Judge, FindsWhatAFrameLacksSlow) {
    // A fifth of the light is taken away after gathering.
    JudgedRoom room(0.0f);
    const auto before = room.judge(12);
    for (glm::vec3& pixel : room.lit.radiance.combined.values()) pixel *= 0.8f;
    ErrorSplit whole, dimmed;
    whole.add(before, luma);
    dimmed.add(room.judge(12), luma);
    const auto bias = [](const ErrorSplit& s, ErrorCause cause) { return s.bias(cause).value; };
    EXPECT_NEAR(bias(dimmed, ErrorCause::gathering), -0.2 * (1 + bias(whole, ErrorCause::total)), 1e-3);
    EXPECT_EQ(bias(dimmed, ErrorCause::light_points), bias(whole, ErrorCause::light_points));
    EXPECT_EQ(bias(dimmed, ErrorCause::eye_samples), bias(whole, ErrorCause::eye_samples));
}

/// Pixels of luminance `light` whose causes have these errors, with a truth that is known to `noise`.
std::vector<ValidatedPixel> synthetic(std::array<double, 3> errors, double light, double noise, std::size_t count) {
    std::vector<ValidatedPixel> pixels(count);
    for (std::size_t i = 0; i < count; ++i) {
        ValidatedPixel& p = pixels[i];
        const double whole = light * (1 + 0.5 * core::uniform(1, i));
        const double at_points = whole + errors[2];
        p.at_points = glm::vec3(glm::dvec3(at_points + errors[1]));
        p.shown = glm::vec3(glm::dvec3(at_points + errors[1] + errors[0]));
        for (std::size_t half = 0; half < 2; ++half) {
            const auto dice = [&](std::uint64_t k) {
                return noise * (core::uniform(2 + k, i, half) - 0.5f) * std::sqrt(12.0);
            };
            p.truth.whole.halves[half] = glm::dvec3(whole + dice(0));
            p.truth.at_points.halves[half] = glm::dvec3(at_points + dice(1));
        }
    }
    return pixels;
}

TEST(ErrorSplit, DoesNotCountTheTruthsOwnError) {
    const std::array<double, 3> errors{0.02, 0.05, -0.03};
    ErrorSplit split;
    // In two frames: sums add up.
    for (int frame = 0; frame < 2; ++frame) split.add(synthetic(errors, 1, 0.1, 20000), luma);
    double sum = 0;
    for (std::size_t c = 0; c < errors.size(); ++c) {
        const auto cause = static_cast<ErrorCause>(c);
        const MeanError square = split.mean_square(cause, ErrorMeasure::luminance),
                        code = split.mean_square(cause, ErrorMeasure::code_value), bias = split.bias(cause),
                        dark = split.dark_bias(cause);
        EXPECT_NEAR(square.value, errors[c] * errors[c], 4 * square.error + 1e-7) << c;
        EXPECT_NEAR(code.value, 400 * errors[c] * errors[c], 4 * code.error + 1e-4) << c;
        EXPECT_NEAR(bias.value, errors[c] / 1.25, 4 * bias.error + 0.01 * std::abs(errors[c])) << c;
        EXPECT_NEAR(dark.value, errors[c] / 1.125, 4 * dark.error + 0.005) << c;
        sum += bias.value;
    }
    EXPECT_NEAR(split.bias(ErrorCause::total).value, sum, 1e-7);
    EXPECT_LT(split.mean_square(ErrorCause::light_points, ErrorMeasure::luminance).error, 0.2 * 0.05 * 0.05);
    EXPECT_NEAR(split.rms(ErrorCause::gathering, ErrorMeasure::luminance), 0.02, 1e-5);
    EXPECT_NEAR(split.rms(ErrorCause::gathering, ErrorMeasure::relative), 0.02 / 1.25, 0.001);
}

TEST(ErrorSplit, OfNoPixelsIsOfNoError) {
    ErrorSplit split;
    split.add({}, luma);
    split.add(std::vector<ValidatedPixel>(3), luma);  // black ones
    for (std::size_t c = 0; c < cause_count; ++c) {
        const auto cause = static_cast<ErrorCause>(c);
        for (const MeanError m :
             {split.mean_square(cause, ErrorMeasure::luminance), split.mean_square(cause, ErrorMeasure::relative),
              split.mean_square(cause, ErrorMeasure::code_value), split.bias(cause), split.dark_bias(cause)}) {
            EXPECT_EQ(m.value, 0.0);
            EXPECT_EQ(m.error, 0.0);
        }
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
