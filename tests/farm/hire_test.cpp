#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "app/estimate/hire.h"
#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "farm/farm_film.h"

/// Hours and money of machines that may be had.
namespace render2mpeg {
namespace {

TEST(Prices, AreOfCoresOrOfMachines) {
    EXPECT_DOUBLE_EQ(app::price_from("0.04/core-hour").of_core_hour(16), 0.04);
    EXPECT_DOUBLE_EQ(app::price_from("0.64/machine-hour").of_core_hour(16), 0.04);
    for (const char* wrong : {"", "0.04", "/core-hour", "-1/core-hour", "0.04/hour", "x/core-hour", "nan/core-hour"})
        EXPECT_THROW(app::price_from(wrong), app::UsageError) << wrong;
}

TEST(Hire, IsAsFastAsWhatWasMeasured) {
    EXPECT_DOUBLE_EQ(app::speed_up(1), 1);
    // cornell and Sponza (docs/measurements.md#many-cores).
    EXPECT_GT(app::speed_up(4), 3.4);
    EXPECT_LT(app::speed_up(4), 3.8);
    EXPECT_GT(app::speed_up(16), 7.9);
    EXPECT_LT(app::speed_up(16), 12.0);
    EXPECT_GT(app::speed_up(64), 11.2);
    EXPECT_LT(app::speed_up(64), 25.7);
}

TEST(Hire, GivesTheLongestPartToTheFirstMachineThatIsFree) {
    EXPECT_DOUBLE_EQ(app::farm_seconds({2, 3, 2, 3, 2}, 1), 12);
    EXPECT_DOUBLE_EQ(app::farm_seconds({1, 1, 1, 9}, 2), 9) << "the last part would end at 11 else";
    EXPECT_DOUBLE_EQ(app::farm_seconds({1, 4, 2}, 100), 4);
    EXPECT_DOUBLE_EQ(app::farm_seconds({}, 3), 0);
}

/// Core-hours and cost in a line of the plan.
std::pair<double, double> paid(const std::string& text, const std::string& line) {
    std::smatch found;
    const std::regex told(line + ".* ([0-9.e+-]+) core-hours, ([0-9.]+)");
    if (!std::regex_search(text, found, told)) return {};
    return {std::stod(found[1]), std::stod(found[2])};
}

TEST(Hire, IsToldByThePlanSlow) {
    const auto said = support::run(support::program() + " plan " + support::plain_film() +
                                   " --hold --frames 0:9999 --size 64x48 --within 1s --quiet --machines 8 --cores 16 "
                                   "--price 3200/machine-hour");
    ASSERT_EQ(said.status, 0) << said.output;
    const auto [one_hours, one_cost] = paid(said.output, "One machine of 16 cores: about");
    const auto [farm_hours, farm_cost] = paid(said.output, "A farm of 8 such machines, --parts [0-9]+: about");
    EXPECT_GT(one_hours, 0) << said.output;
    EXPECT_NEAR(one_cost, 200 * one_hours, 0.01 * one_cost);
    EXPECT_NEAR(farm_cost, 200 * farm_hours, 0.01 * farm_cost);
    EXPECT_GT(farm_hours, one_hours) << "every part begins anew";
    EXPECT_LT(farm_hours, 3 * one_hours) << said.output;
    EXPECT_EQ(support::run(support::program() + " plan " + support::plain_film() + " --within 0").output.find("hours"),
              std::string::npos)
        << "nobody asked";
}

TEST(FarmStatus, TellsWhatWasSpentAndWhatIsLeftSlow) {
    const test::FarmFilm film("", 240);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to parallel").status, 0);
    const auto status = [&] {
        return support::run(support::program() + " farm-status --price 1e6/core-hour " + film.path("f.mpg.farm"))
            .output;
    };
    EXPECT_EQ(status().find("spent"), std::string::npos) << "nothing is made";
    std::vector<double> spent, left;
    for (const int part : {2, 1, 4, 3}) {
        ASSERT_EQ(support::run(film.part("f.mpg.farm", part)).status, 0);
        std::smatch found;
        const std::string said = status();
        ASSERT_TRUE(std::regex_search(said, found, std::regex("spent .*, ([0-9.]+); left about .*, ([0-9.]+)")))
            << said;
        spent.push_back(std::stod(found[1]));
        left.push_back(std::stod(found[2]));
    }
    EXPECT_TRUE(std::ranges::is_sorted(spent));
    EXPECT_GT(spent.front(), 0);
    EXPECT_GT(left.front(), left[2]) << "three parts of four, and one";
    EXPECT_EQ(left.back(), 0);
    EXPECT_NEAR(left[2], spent[2] / 3, spent[2] / 6) << "all chunks have the same forecast";
    // The records count what all parts took.
    const double planned = nlohmann::json::parse(support::contents(film / "f.mpg.farm/plan.json"))["cost"]["cpu"];
    EXPECT_GT(spent.back(), 1e6 / 3600 * planned);
}

TEST(FarmStatus, KnowsThatWhatIsLeftIsDearer) {
    const test::FarmFilm film("", 120);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to parallel").status, 0);
    ASSERT_EQ(support::run(film.part("f.mpg.farm", 2)).status, 0);
    const auto told = [&](double first) {
        nlohmann::json plan = nlohmann::json::parse(support::contents(film / "f.mpg.farm/plan.json"));
        plan["forecast"] = {first, 2.0};
        plan["cost"]["cpu"] = 0;
        std::ofstream(film / "f.mpg.farm/plan.json", std::ios::trunc) << plan;
        const std::string said =
            support::run(support::program() + " farm-status --price 1e6/core-hour " + film.path("f.mpg.farm")).output;
        std::smatch found;
        EXPECT_TRUE(std::regex_search(said, found, std::regex("spent .*, ([0-9.]+); left about .*, ([0-9.]+)")))
            << said;
        return found.empty() ? 0 : std::stod(found[2]) / std::stod(found[1]);
    };
    EXPECT_NEAR(told(2), 1, 0.01);
    EXPECT_NEAR(told(20), 10, 0.1);
}

TEST(Hire, TellsTheLongestPartByItsShots) {
    const test::FarmFilm scene("", 240, "96x16", test::dear_shot_scene());
    app::RenderOptions options;
    options.input = scene / "scene.json";
    options.output = scene / "film.mpg";
    options.size = {96, 16};
    options.samples = 1;
    options.coding.gop = 30;
    const app::RenderJob film = app::prepare(options);
    app::Forecast forecast;
    forecast.cpu = 4000;
    const std::string said = app::hire_text(film, forecast, {{}, 4, 1}, true);
    std::smatch found;
    ASSERT_TRUE(std::regex_search(said, found, std::regex("longest part ([0-9]+):([0-9]+)"))) << said;
    EXPECT_GT(60 * std::stoi(found[1]) + std::stoi(found[2]), 1500) << "a quarter of the film has 1000 s";
}

}  // namespace
}  // namespace render2mpeg
