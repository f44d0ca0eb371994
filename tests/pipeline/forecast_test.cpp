#include "app/estimate/forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "app/experiments/film_costs.h"
#include "app/experiments/trial.h"
#include "app/options/option_text.h"
#include "support/program.h"

/// What a few frames tell of a whole film, and of its effects.
namespace render2mpeg {
namespace {

using app::Chunk;
using app::RenderJob;

RenderJob small_film(const std::string& scene, const std::string& size = "32x32") {
    app::RenderOptions options;
    options.input = scene;
    options.output = "film.mpg";
    options.size = app::size_from(size);
    RenderJob film = app::prepare(options);
    film.exposure = 0;
    return film;
}

const RenderJob& flash_cut() {
    static const RenderJob film = small_film(support::film("flash_cut"));
    return film;
}

TEST(Forecast, CountsFramesByTheirKinds) {
    RenderJob film = flash_cut();  // 72 frames, chunks of 60, a cut at 36
    film.coding.gop = 15;
    app::FrameSample sample;
    sample.first = {8, 1000};
    sample.later = {1, 100};
    const app::FrameCost whole = app::film_by(film, sample);
    // Two chunks' first frames and the cut's; groups of 0 to 35, 36 to 59 and 60 to 71.
    const double groups = 3 + 2 + 1;
    EXPECT_NEAR(whole.seconds, 3 * 8 + 69 * 0.93, 1e-9);
    EXPECT_NEAR(whole.bytes, groups * 1000 + (72 - groups) * 110, 1e-9);
    film.frames = {0, 5};
    EXPECT_NEAR(app::film_by(film, sample).seconds, 8 + 5, 1e-9) << "it was lit whole";
}

TEST(Forecast, GrowsByItsPowers) {
    app::FrameSample sample;
    sample.first = {8, 1000};
    sample.later = {1, 100};
    const app::Growth growth{{0.5, 0.8}, {0.7, 0.8}};
    const app::FrameSample grown = app::grown(sample, 4, growth);
    EXPECT_NEAR(grown.first.seconds, 16, 1e-9);
    EXPECT_NEAR(grown.later.seconds, std::pow(4, 0.7), 1e-9);
    // 32 rows of macroblocks for 16, and detail by its power.
    sample.size = {256, 256};
    sample.later.bytes = 1000;
    EXPECT_NEAR(app::grown(sample, 4, growth).later.bytes, 16 + 8 * 32 + (1000 - 16 - 8 * 16) * std::pow(4, 0.8), 1e-9);
    // Pictures of other codecs have one slice.
    sample.codec = encoder::Codec::h264;
    sample.later.bytes = 13;
    EXPECT_NEAR(app::grown(sample, 4, growth).later.bytes, 12 + std::pow(4, 0.8), 1e-9);
}

TEST(Forecast, LearnsItsPowersFromTwoSizes) {
    app::FrameSample small, large;
    small.size = {64, 64};
    large.size = {128, 128};
    const double headers = 16 + 8 * 4, larger_headers = 16 + 8 * 8;
    small.first = {1, headers + 100};
    large.first = {4, larger_headers + 400};
    small.later = {1, headers + 100};
    large.later = {1, larger_headers + 100};
    const app::Growth growth = app::growth_between(&small, large);
    EXPECT_NEAR(growth.first.seconds, 1, 1e-9) << "as measured";
    EXPECT_NEAR(growth.first.bytes, 0.9, 1e-9) << "half of what is usual, half as measured";
    EXPECT_NEAR(growth.later.seconds, 0.15, 1e-9) << "no film takes less";
    EXPECT_NEAR(growth.later.bytes, 0.65, 1e-9);
    large.size = {64, 64};
    EXPECT_NEAR(app::growth_between(&small, large).later.seconds, 0.5, 1e-9) << "one size tells nothing";
    EXPECT_NEAR(app::growth_between(nullptr, large).later.bytes, 0.8, 1e-9);
}

TEST(Forecast, TakesWindowsFromTheMiddlesOfEqualParts) {
    const std::vector<Chunk> two = app::middle_windows(flash_cut(), 2, 4);
    ASSERT_EQ(two.size(), 2u);
    EXPECT_EQ(two[0].first, 16);
    EXPECT_EQ(two[1].first, 52);
    EXPECT_EQ(app::middle_windows(flash_cut(), 1, 100).front().frames(), 72) << "no more than the film has";
    EXPECT_EQ(app::resized(small_film(support::plain_film(), "64x64"), 0.5).format.width, 32);
}

TEST(Forecast, OfAShortFilmIsWhatItTakes) {
    RenderJob film = small_film(support::plain_film());
    film.frames = {0, 5};
    const auto found = app::forecast(film, "film.mpg", 60, true);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->sample.frames, 6);
    EXPECT_EQ(found->sample.size.width, 32);
    // All of its frames were lit and coded.
    double bytes = 0;
    for (const app::FrameEntry& entry : found->sample.statistics.frames) bytes += static_cast<double>(entry.bytes);
    EXPECT_NEAR(found->bytes, bytes * 1.018 <= 2048 ? 2052 : bytes * 1.018 + 1028, 0.15 * bytes);
    EXPECT_GT(found->memory, std::uint64_t{1} << 20);
    EXPECT_DOUBLE_EQ(found->disk, 2 * found->bytes);
}

TEST(Forecast, LightsAWindowOfEachShotSlow) {
    RenderJob film = small_film(support::film("flash_cut"), "16x16");  // a cut at 36
    const auto found = app::forecast(film, "film.mpg", 60, true);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->sample.windows.size(), 2u);
    const auto& lit = found->sample.statistics.frames;
    EXPECT_EQ(std::count_if(lit.begin(), lit.end(), [](const app::FrameEntry& entry) { return entry.frame < 36; }), 6);
    EXPECT_EQ(lit.size(), 12u);
}

TEST(Forecast, CountsTheChannelsOfTheSound) {
    RenderJob film = small_film(support::plain_film(), "16x16");
    film.frames = {0, 1};
    film.sound.file = "not read here";
    const auto bytes = [&](int channels, const char* name) {
        film.sound.channels = channels;
        return app::forecast(film, name, 1, true).value().bytes;
    };
    const double seconds = 2 / film.rate.hertz.value();
    EXPECT_NEAR(bytes(2, "film.mpg") - bytes(1, "film.mpg"), 128e3 / 8 * seconds, 400) << "in packs of 2048";
    EXPECT_NEAR(bytes(2, "film.mp4") - bytes(1, "film.mp4"), 96e3 / 8 * seconds, 1);
}

TEST(Forecast, StopsInTheMidstOfAFrameAndTellsTheLeast) {
    RenderJob film = small_film(support::plain_film(), "64x64");
    app::LoopObserver nobody;
    app::Progress progress(1, true);
    const auto sample = app::sample_frames({film, {{{0, 0, 3}}, {}}}, nobody, progress, [] { return true; });
    ASSERT_TRUE(sample.has_value());
    EXPECT_EQ(sample->frames, 0) << "its time was over";
    EXPECT_GE(sample->cpu, 0) << "clocks of processors may not have moved";
    const auto found = app::forecast(film, "film.mpg", 1e-9, true);
    ASSERT_TRUE(found.has_value());
    ASSERT_TRUE(found->is_least);
    EXPECT_GE(found->cpu, found->sample.cpu) << "there are other frames";
    const std::string said = app::text_of(*found);
    EXPECT_TRUE(said.starts_with("Takes more than ")) << said;
    EXPECT_NE(said.find(" not one frame of 48x48 was lit"), std::string::npos) << said;
    EXPECT_EQ(said.find("the film has"), std::string::npos) << said;
}

TEST(Forecast, NeedsOneFrameOnly) {
    struct Coded : app::LoopObserver {
        void coded(const encoder::CodedPicture&) override { any = true; }
        bool any = false;
    } observer;
    app::Progress progress(1, true);
    const RenderJob film = small_film(support::plain_film(), "64x64");
    const auto sample = app::sample_frames({film, {{{0, 0, 3}}, {}}}, observer, progress, [&] { return observer.any; });
    ASSERT_TRUE(sample.has_value());
    ASSERT_EQ(sample->frames, 1);
    EXPECT_NEAR(sample->later.seconds, 0.7 * sample->first.seconds, 1e-9);
    EXPECT_NEAR(sample->later.bytes, 0.2 * sample->first.bytes, 1e-9);
}

TEST(Windows, StandForTheirShotsByTheirLengths) {
    RenderJob film = flash_cut();  // a cut at 36
    film.frames = {20, 71};
    const app::SampleWindows two = app::sample_windows(film, 4, 6);
    ASSERT_EQ(two.all.size(), 2u);
    EXPECT_EQ(two.all[0].first, 25);
    EXPECT_EQ(two.all[1].last, 56);
    EXPECT_EQ(two.weights, (std::vector<double>{16, 36}));
    // As many windows as there may be, where shots are more: none has a cut in it.
    const app::SampleWindows one = app::sample_windows(film, 1, 30);
    ASSERT_EQ(one.all.size(), 1u);
    EXPECT_EQ(one.all[0].first, 36) << "the longer part";
    EXPECT_EQ(one.all[0].last, 60);
}

TEST(Windows, LieInEachShot) {
    RenderJob film = flash_cut();  // 72 frames, a cut at 36
    const std::vector<Chunk> two = app::windows_by_shot(film, {4, 5});
    ASSERT_EQ(two.size(), 2u);
    EXPECT_EQ(two[0].first, 16);
    EXPECT_EQ(two[0].last, 20);
    EXPECT_EQ(two[1].first, 52);
    EXPECT_EQ(two[1].index, 1);
    film.frames = {0, 35};
    EXPECT_EQ(app::windows_by_shot(film, {4, 5}).size(), 4u) << "one shot: its parts";
}

TEST(Effects, LeaveOutTheOnlyLightOfMovingThingsSlow) {
    // The same as a lamp that goes out: no photon starts, and none can be kept.
    const RenderJob film = small_film(support::plain_film());
    const app::EffectCosts costs =
        app::effect_costs(film, 2, std::numeric_limits<double>::infinity(), true, [](const app::EffectCost&, bool) {});
    const auto lamps = std::find_if(costs.rows.begin(), costs.rows.end(),
                                    [](const app::EffectCost& cost) { return cost.name == "lamps"; });
    ASSERT_NE(lamps, costs.rows.end());
    for (const auto y : lamps->without.y.values()) ASSERT_EQ(y, 16);
}

TEST(Effects, AreTheRowsOfThePlanThatRun) {
    for (const char* scene : {"mirror_and_glass", "flash_cut"}) {
        const RenderJob film = small_film(support::film(scene));
        std::set<std::string> expected, names;
        for (const renderer::PlanRow& row : film.plan.rows())
            if (row.runs && *row.effect != '\0') expected.insert(row.effect);
        for (const app::Setting& less : app::left_out_of(film)) {
            names.insert(less.name);
            if (!less.choices.empty()) continue;
            int fewer = 0;
            for (const renderer::PlanRow& row : film.plan.rows())
                fewer += row.runs && !less.film.plan.runs(row.pass) ? 1 : 0;
            EXPECT_GE(fewer, 1) << less.name;
        }
        EXPECT_GE(expected.size(), 4u);
        EXPECT_TRUE(std::includes(names.begin(), names.end(), expected.begin(), expected.end()));
        EXPECT_TRUE(names.contains("coupling"));
    }
}

TEST(Effects, ChangeThePicturesThatTheyAreLeftOutOfSlow) {
    RenderJob film = small_film(support::film("cornell"), "16x16");
    const app::EffectCosts costs =
        app::effect_costs(film, 2, std::numeric_limits<double>::infinity(), true, [](const app::EffectCost&, bool) {});
    EXPECT_EQ(costs.left, 0);
    EXPECT_EQ(costs.frames, 2);
    EXPECT_EQ(costs.size.width, 16);
    const auto named = [&](const std::string& name) {
        const auto found = std::find_if(costs.rows.begin(), costs.rows.end(),
                                        [&](const app::EffectCost& cost) { return cost.name == name; });
        if (found != costs.rows.end()) return *found;
        ADD_FAILURE() << name;
        return app::EffectCost{};
    };
    for (const char* name : {"textures", "light of shining surfaces", "bounced light"}) {
        const app::EffectCost cost = named(name);
        ASSERT_TRUE(cost.difference.has_value()) << name;
        EXPECT_LT(*cost.difference, 40) << name;
        EXPECT_EQ(cost.whole.number, cost.without.number);
    }
    // Light only adds.
    const app::EffectCost bounced = named("bounced light");
    double with = 0, without = 0;
    for (const auto y : bounced.whole.y.values()) with += y;
    for (const auto y : bounced.without.y.values()) without += y;
    EXPECT_GT(with, 1.05 * without);
    // What is only how light is made shows little.
    EXPECT_GT(named("area lamps in closed form").difference.value_or(99), 40);
}

TEST(Effects, NoneIsBegunAfterItsTime) {
    const RenderJob film = small_film(support::plain_film());
    const app::EffectCosts costs = app::effect_costs(film, 2, 0, true, [](const app::EffectCost&, bool) {});
    EXPECT_TRUE(costs.rows.empty());
    EXPECT_EQ(costs.left, static_cast<int>(app::left_out_of(film).size()));
}

TEST(Effects, SayWhatCannotBeToldApart) {
    EXPECT_EQ(app::share_text(0.41), "41 %");
    EXPECT_EQ(app::share_text(-0.12), "saves 12 %");
    EXPECT_EQ(app::share_text(-0.02), "under 3 %");
    EXPECT_NE(app::effect_row({"gloss", "", 0.2, {}, 0, {}, {}}).find("none you can see\n"), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg
