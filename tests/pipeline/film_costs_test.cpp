#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "app/experiments/comparison.h"
#include "app/experiments/film_costs.h"
#include "app/job/render_job.h"
#include "app/options/film.h"
#include "app/options/option_text.h"
#include "app/report/figures.h"
#include "pipeline/fixture.h"

/// What a film costs before it is made, and what is told of it; and what is asked before one is replaced.
namespace render2mpeg::test {
namespace {

using app::FilmCost;

FilmCost row(const char* name, double cpu, std::optional<double> added, double loss) {
    static const app::Trial trial;
    const bool by_truth = std::string(name) == "truth";
    return {name, {{"--tolerance", name}}, by_truth ? nullptr : &trial, cpu / 2, cpu, 1e5, added, loss};
}

TEST(Offers, AreTakenByOneRule) {
    EXPECT_FALSE(app::cheapest_alike({}).has_value());
    const std::vector<app::Offer> offers{{1, false}, {9, true}, {4, true}, {5, true}};
    EXPECT_EQ(app::cheapest_alike(offers), 2u) << "the cheapest that nobody can tell from the best";
    EXPECT_EQ(app::time_text(75, 140.4), "1:15 (140 s of CPU)");
}

TEST(FilmCosts, TakeTheCheapestRowThatNobodyCanTellFromTheBest) {
    const std::vector<FilmCost> costs{row("fixed=8%", 10, 43, 1.2), row("coupled", 14, 51, 0.1),
                                      row("fixed=1%", 14.2, {}, 0), row("truth", 99, {}, 0)};
    EXPECT_EQ(app::recommended(costs), 1u);
    EXPECT_FALSE(app::recommended(std::vector<FilmCost>()).has_value());
    EXPECT_EQ(app::words_for(43), "slight in flat areas");
    EXPECT_EQ(app::words_for(30), "visible");
    EXPECT_EQ(app::words_for({}), "none you can see");

    // The table and the sentence say the same.
    const std::string table = app::film_cost_table(costs);
    EXPECT_EQ(table.find("<- take"), table.find("<- take", table.find("coupled")));
    EXPECT_NE(table.find("exact, by paths to 3 %\n"), std::string::npos) << table;
    EXPECT_TRUE(app::answer_of(costs, 60).starts_with("Take coupled: your film of 60 frames takes about 0:07 ("));
}

TEST(FilmCosts, OfEffortsKeepWhatIsAskedForByHand) {
    app::RenderJob film;
    film.tolerance.coupled = true;
    film.tolerance.loss = film.coupling.loss = 0.7;
    film.rendering.most_samples = 256;
    app::RenderOptions options;
    const app::Effort& low = app::effort_from("low");
    const app::RenderJob plain = app::at_effort(film, low, options);
    EXPECT_DOUBLE_EQ(plain.coupling.loss, low.loss);
    EXPECT_EQ(plain.rendering.samples, low.samples);

    options.loss = 0.7;
    options.said["--samples"] = "4";
    const app::RenderJob asked = app::at_effort(film, low, options);
    EXPECT_DOUBLE_EQ(asked.tolerance.loss, 0.7);
    EXPECT_DOUBLE_EQ(asked.coupling.loss, 0.7);
    EXPECT_EQ(asked.rendering.samples, 4);

    film.tolerance = {};
    options.tolerance = app::fixed_tolerance(0.02f);
    EXPECT_FLOAT_EQ(app::at_effort(film, low, options).tolerance.relative, 0.02f);
    EXPECT_FLOAT_EQ(app::at_effort(film, low, {}).tolerance.relative, low.fixed);
}

/// Two rows by quantiser; bits at equal quality follow from `bytes`, times from `cpu`.
app::Way way(const std::string& name, double bytes, double cpu) {
    app::Way made{name, name, "", std::nullopt, {}};
    for (const int quantiser : {4, 8}) {
        app::Trial trial;
        trial.quantiser = quantiser;
        trial.cpu = cpu;
        trial.clock = cpu / 2;
        trial.bytes = trial.film_bytes = bytes / quantiser;
        for (perceptual::FilmQuality* quality : {&trial.shown, &trial.shown_there, &trial.decoded})
            quality->add(quantiser, 0.9);
        made.rows.push_back(trial);
    }
    return made;
}

TEST(Comparison, TakesTheFasterOfTwoWhoseFilmsAreAsLarge) {
    app::Comparison found;
    found.complete = true;
    found.ways = {way("coupled", 1000, 10), way("fixed 2 %, ours", 999, 16), way("ffmpeg", 1300, 9),
                  way("strongest", 1100, 20)};
    const std::vector<app::WayCost> costs = app::way_costs(found, 60, 0);
    ASSERT_EQ(costs.size(), 4u);
    EXPECT_EQ(costs[0].way, app::fixed_way) << "it has 0.1 % fewer bits";
    EXPECT_EQ(costs[*app::recommended(costs)].way, app::coupled_way) << "and takes longer";
    EXPECT_NEAR(costs[0].bits, 0.999, 1e-6);
    EXPECT_TRUE(app::answer_of(found, 60, 4).starts_with("Take coupled: your film of 60 frames takes about 5:00 (600"))
        << app::answer_of(found, 60, 4);
}

TEST(FilmCosts, HaveSizeAndTimeOfTheFilmAsItWasAskedFor) {
    const auto trial = [](double cpu, double bytes) {
        app::Trial t;
        t.frames = 1;
        t.cpu = t.clock = cpu;
        t.film_bytes = bytes;
        return t;
    };
    app::Sweep sweep;
    sweep.rows = {{"fixed=8%", {{"--tolerance", "fixed=8%"}}, trial(1, 4400)},
                  {"fixed=1%", {{"--tolerance", "fixed=1%"}}, trial(4, 4000)},
                  {"coupled", {{"--tolerance", "coupled"}}, trial(2, 4000)},
                  {"effort draft", {{"--effort", "draft"}}, trial(0.5, 1000)}};
    const auto row_of = [](const std::vector<FilmCost>& rows, const std::string& name) {
        for (const FilmCost& r : rows)
            if (r.name == name) return r;
        return FilmCost{};
    };
    const std::vector<FilmCost> sampled = app::film_costs(sweep, 60);
    EXPECT_DOUBLE_EQ(row_of(sampled, "effort draft").bytes, 60'000);
    EXPECT_DOUBLE_EQ(row_of(sampled, "coupled").bytes, 240'000);
    EXPECT_DOUBLE_EQ(row_of(sampled, "coupled").cpu, 120);
    EXPECT_EQ(row_of(sampled, "truth").name, "") << "nobody found it";
    sweep.forecast.emplace();
    sweep.forecast->cpu = 180;
    sweep.forecast->clock = 90;
    sweep.forecast->bytes = 50'000;
    sweep.truth = app::PathTruth{64, 1000, 0.01, 0.5, 45};
    sweep.pixels = 2000;
    const std::vector<FilmCost> told = app::film_costs(sweep, 60);
    EXPECT_DOUBLE_EQ(row_of(told, "coupled").bytes, 50'000) << "one forecast for all that is told";
    EXPECT_DOUBLE_EQ(row_of(told, "coupled").clock, 90);
    EXPECT_DOUBLE_EQ(row_of(told, "coupled").cpu, 180);
    EXPECT_DOUBLE_EQ(row_of(told, "fixed=8%").bytes, 55'000) << "others in proportion";
    EXPECT_DOUBLE_EQ(row_of(told, "fixed=8%").cpu, 90);
    EXPECT_DOUBLE_EQ(row_of(told, "effort draft").bytes, 12'500);
    EXPECT_DOUBLE_EQ(row_of(told, "truth").cpu, 60 * 2000 * 0.5 * 0.01 + 90 * 4) << "light of each pixel, and all else";
}

TEST(Forecast, IsWhatPlanBeginsWith) {
    const std::string tiny = " --size 32x32 --samples 1 --frames 0:3 ";
    const auto told = run(program() + " plan " + plain_film() + tiny + "--within 20s 2>/dev/null");
    ASSERT_EQ(told.status, 0) << told.output;
    for (const char* words : {": 4 frames (0 to 3; 0.16 s) of 32x32 at 25 Hz", "Takes about ", "Memory: about ",
                              "Disk while it is made", " frames lit at 32x32", "these sample frames"})
        EXPECT_NE(told.output.find(words), std::string::npos) << words << "\n" << told.output;
    EXPECT_EQ(run(program() + " plan " + plain_film() + tiny + "--within 0").output.find("Takes about"),
              std::string::npos);
}

TEST(Options, AreTakenAsPeopleWriteThem) {
    EXPECT_EQ(app::size_from("160X120").height, 120);
    EXPECT_FLOAT_EQ(app::tolerance_from("2%").relative, 0.02f);
    EXPECT_FALSE(app::tolerance_from("2%").coupled);
    EXPECT_DOUBLE_EQ(app::time_in_seconds("1:30"), 90);
    EXPECT_DOUBLE_EQ(app::time_in_seconds("1:00:05"), 3605);
    for (const char* wrong : {"1:60", "1:2:3:4", ":30", "1:", "0:00"})
        EXPECT_THROW(app::time_in_seconds(wrong), std::exception) << wrong;
    EXPECT_DOUBLE_EQ(app::within_from("0"), 0);
    EXPECT_EQ(run(program() + " help render").output, run(program() + " render --help").output);
}

}  // namespace
}  // namespace render2mpeg::test
