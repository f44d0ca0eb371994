#include "app/loop/film_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/gop_starts.h"
#include "support/program.h"

/// What a few frames tell of a whole film, and of its effects.
namespace render2mpeg {
namespace {

using app::AbruptFrames;
using app::Chunk;
using app::FilmSample;
using app::RenderJob;

RenderJob small_film(const std::string& scene, const std::string& size = "32x32",
                     const std::string& indirect = "lightcuts") {
    app::RenderOptions options;
    options.input = scene;
    options.output = "film.mpg";
    options.size = size;
    options.vpls = 16;
    options.indirect = indirect;
    options.given = {"--vpls"};
    RenderJob film = app::prepare(options);
    film.exposure = 0;
    return film;
}

const RenderJob& flash_cut() {
    static const RenderJob film = small_film(support::film("flash_cut"));
    return film;
}

TEST(FilmSample, CountsFirstFramesOnceAndTheRestAsTheLastOnes) {
    EXPECT_DOUBLE_EQ(app::chunk_seconds({8, 3, 1, 1}, 10), 8 + 3 + 8 * 1);
    EXPECT_DOUBLE_EQ(app::chunk_seconds({8, 2}, 5), 8 + 4 * 2);
    EXPECT_DOUBLE_EQ(app::chunk_seconds({8}, 2), 16);
}

TEST(FilmSample, KnowsCutsAndLightsThatComeAndGo) {
    const AbruptFrames abrupt = app::abrupt_frames(flash_cut());
    EXPECT_EQ(abrupt.cuts, (std::vector<std::int64_t>{36}));
    EXPECT_EQ(abrupt.switches, (std::vector<std::int64_t>{12, 20, 21, 23, 30, 32, 54, 60, 62}))
        << "but not the sign that fades";
    EXPECT_TRUE(abrupt.contains(36));
    EXPECT_FALSE(abrupt.contains(37));
    EXPECT_EQ(app::abrupt_frames(small_film(support::plain_film())).count(), 0u);
}

TEST(FilmSample, HasAbruptFramesInItsWindows) {
    const RenderJob& film = flash_cut();
    const AbruptFrames abrupt = app::abrupt_frames(film);
    for (const int count : {1, 2, 4})
        for (const int length : {3, 5}) {
            const std::vector<Chunk> windows = app::sample_windows(film, count, length, abrupt);
            ASSERT_EQ(windows.size(), static_cast<std::size_t>(count));
            for (const Chunk& window : windows) {
                EXPECT_EQ(window.frames(), length);
                bool has = false;
                for (std::int64_t n = window.first + 1; n <= window.last; ++n) has = has || abrupt.contains(n);
                EXPECT_TRUE(has) << window.first;
                // Within its part of the film, or from the frame before it.
                EXPECT_GE(window.first, 72 * window.index / count - 1);
                EXPECT_LE(window.last, 72 * (window.index + 1) / count - 1);
            }
        }
    const std::vector<Chunk> even = app::sample_windows(film, 2, 4, {});
    EXPECT_EQ(even[0].first, 16);
    EXPECT_EQ(even[1].first, 52);
}

TEST(FilmSample, TellsTheFilmByItsKindsOfFrames) {
    RenderJob film = flash_cut();  // 72 frames, chunks of 60
    film.coding.gop = 15;
    const AbruptFrames abrupt = app::abrupt_frames(film);
    FilmSample sample;
    // A window over the switch at 12, and one over the cut.
    sample.windows.push_back({11, {8, 3, 1, 1}, {0, 0, 0, 0}, {1000, 900, 100, 100}});
    sample.windows.push_back({35, {8, 2, 1, 1}, {0, 0, 0, 0}, {1000, 1000, 100, 100}});
    const app::SampledFilm whole = app::film_by(sample, film, film, abrupt);
    // Two chunks' first frames, ten abrupt ones that take 1.5 s more, and the rest.
    EXPECT_DOUBLE_EQ(whole.cpu, 2 * 8 + 70 * 1 + 10 * 1.5);
    // Groups of 0 to 35, 36 to 59 and 60 to 71; nine switches.
    const double groups = 3 + 2 + 1;
    EXPECT_DOUBLE_EQ(whole.bytes, groups * 1000 + 9 * 900 + (72 - groups - 9) * 100);
    EXPECT_DOUBLE_EQ(whole.first, 8);
    EXPECT_DOUBLE_EQ(whole.later, 1);
    EXPECT_DOUBLE_EQ(whole.apart, 0);
}

TEST(GopStarts, CountAsOftenAsTheFilmHasThem) {
    RenderJob film = flash_cut();  // 72 frames
    const std::vector<Chunk> windows{{0, 0, 14}, {1, 30, 44}};
    app::GopStarts starts;
    encoder::CodedPicture picture;
    picture.bytes.resize(1000);
    picture.plan.starts_gop = false;
    starts.add(picture);
    EXPECT_EQ(starts.surplus(film, windows, 160), 0) << "it begins none";
    picture.plan.starts_gop = true;
    starts.add(picture);
    starts.add(picture);
    film.coding.gop = 60;
    EXPECT_NEAR(160 - starts.surplus(film, windows, 160), (1000 + 59 * 100) / 60.0, 1e-9);
    film.coding.gop = 15;
    EXPECT_NEAR(starts.surplus(film, windows, 160), 0, 1e-9);
}

TEST(FilmSample, GrowsWithThePixelsButForItsLightPoints) {
    const RenderJob large = small_film(support::plain_film(), "64x64"), small = app::resized(large, 0.5);
    EXPECT_EQ(small.format.width, 32);
    FilmSample sample;
    sample.windows.push_back({0, {5, 3, 3}, {4, 2, 2}, {100, 10, 10}});
    const app::SampledFilm whole = app::film_by(sample, large, small, {});
    EXPECT_DOUBLE_EQ(whole.first, 4 + 4 * 1);
    EXPECT_DOUBLE_EQ(whole.later, 2 + 4 * 1);
}

TEST(Effects, LeaveOutTheOnlyLightOfMovingThings) {
    // The same as a lamp that goes out: no photon starts, and none can be kept.
    const RenderJob film = small_film(support::plain_film());
    const app::EffectCosts costs =
        app::effect_costs(film, {1, 2}, std::numeric_limits<double>::infinity(), true, [](const app::EffectCost&) {});
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
        for (const app::LeftOut& less : app::left_out_of(film)) {
            names.insert(less.name);
            if (!less.option.empty()) continue;
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
    RenderJob film = small_film(support::film("cornell"), "16x16", "rays");
    const app::EffectCosts costs =
        app::effect_costs(film, {1, 2}, std::numeric_limits<double>::infinity(), true, [](const app::EffectCost&) {});
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
    EXPECT_GT(named("lamps as a whole").difference.value_or(99), 40);
}

TEST(Effects, NoneIsBegunAfterItsTime) {
    const RenderJob film = small_film(support::plain_film());
    const app::EffectCosts costs = app::effect_costs(film, {1, 2}, 0, true, [](const app::EffectCost&) {});
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
