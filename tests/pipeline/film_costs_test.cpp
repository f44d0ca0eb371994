#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "app/experiments/film_costs.h"
#include "app/options/option_text.h"
#include "app/report/answer.h"
#include "pipeline/fixture.h"

/// What a film costs before it is made, and what is told of it; and what is asked before one is replaced.
namespace render2mpeg::test {
namespace {

using app::FilmCost;

FilmCost row(const char* name, double clock, std::optional<double> added, double loss) {
    return {name, clock, 1e5, added, loss, false};
}

TEST(FilmCosts, TakeTheFastestRowWithoutADifferenceThatOneSees) {
    const std::vector<FilmCost> costs{row("fixed=8%", 10, 43, 1.2), row("coupled", 14, 51, 0.1),
                                      row("fixed=1%", 30, {}, 0)};
    EXPECT_FALSE(app::is_free(costs));
    EXPECT_FALSE(app::buys_nothing(costs));
    EXPECT_EQ(app::recommended(costs), 1u);
    EXPECT_EQ(app::words_for(43), "slight in flat areas");
    EXPECT_EQ(app::words_for(30), "visible");
    EXPECT_EQ(app::words_for({}), "none you can see");
    EXPECT_NE(app::film_cost_table(costs, {}).find("coupled"), std::string::npos);
}

TEST(FilmCosts, SayWhereAccuracyIsFree) {
    std::vector<FilmCost> costs{row("fixed=8%", 10, 30, 3), row("fixed=1%", 10.5, {}, 0),
                                row("reference", 10.9, {}, 0)};
    costs.back().is_reference = true;
    EXPECT_TRUE(app::is_free(costs));
    EXPECT_EQ(app::recommended(costs), 2u) << "then the most exact";
    EXPECT_FALSE(app::recommended({}).has_value());
}

TEST(FilmCosts, HaveSizeAndTimeOfTheFilmAsItWasAskedFor) {
    // Two rows of a single frame, which is an I picture: 60 of them are no film.
    const auto trial = [](double cpu, double bytes) {
        app::Trial t;
        t.frames = 1;
        t.cpu = t.clock = cpu;
        t.bytes = bytes;
        return t;
    };
    app::Sweep sweep;
    sweep.fixed = {trial(1, 4400), trial(4, 4000)};
    sweep.fixed[0].tolerance.relative = 0.08f;
    sweep.pairs = {{trial(2, 4000), sweep.fixed[1]}};
    app::RenderJob film;
    film.frames = {0, 59};
    film.tolerance.coupled = true;
    const auto row_of = [](const std::vector<FilmCost>& rows, const std::string& name) {
        for (const FilmCost& r : rows)
            if (r.name == name) return r;
        return FilmCost{};
    };
    sweep.draft = trial(0.5, 1000);
    const std::vector<FilmCost> sampled = app::film_costs(sweep, film);
    EXPECT_DOUBLE_EQ(app::draft_cost(sweep, film)->bytes, 60'000);
    sweep.asked = {3, 50'000};
    const std::vector<FilmCost> told = app::film_costs(sweep, film);
    EXPECT_DOUBLE_EQ(app::draft_cost(sweep, film)->bytes, 12'500) << "as all rows are";
    EXPECT_DOUBLE_EQ(row_of(sampled, "coupled").bytes, 240'000);
    EXPECT_DOUBLE_EQ(row_of(told, "coupled").bytes, 50'000);
    EXPECT_DOUBLE_EQ(row_of(told, "fixed=8%").bytes, 55'000);
    EXPECT_DOUBLE_EQ(row_of(sampled, "coupled").clock, 120);
    EXPECT_DOUBLE_EQ(row_of(told, "coupled").clock, 180) << "it is looked at closer, which the sample is not";
    EXPECT_DOUBLE_EQ(row_of(told, "fixed=8%").clock, 60);
}

TEST(Estimate, IsWhatPlanBeginsWith) {
    const std::string tiny = " --size 32x32 --samples 1 --indirect lightcuts --vpls 16 --frames 0:3 ";
    const auto told = run(program() + " plan " + plain_film() + tiny + "--within 2s 2>/dev/null");
    ASSERT_EQ(told.status, 0) << told.output;
    for (const char* words : {": 4 frames (0 to 3; 0.16 s) of 32x32 at 25 Hz", "Takes about 0:0", "Memory: about ",
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

TEST(Answer, FoldsAndMarks) {
    const std::string table = app::answer_table(
        {"a", "b", "c", "d"}, {{"<x>", 0.5, "1:00", "none", app::Grade::good, "", "1 kB", true}}, "n");
    EXPECT_NE(table.find("&lt;x&gt;"), std::string::npos);
    EXPECT_NE(table.find("take this"), std::string::npos);
    EXPECT_NE(table.find("width:50.0%"), std::string::npos);
    EXPECT_EQ(app::folded("t", ""), "");
}

}  // namespace
}  // namespace render2mpeg::test
