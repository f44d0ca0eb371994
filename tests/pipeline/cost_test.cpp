#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "app/experiments/film_costs.h"
#include "app/experiments/trial.h"
#include "app/experiments/trial_command.h"
#include "app/options/option_text.h"
#include "pipeline/fixture.h"

/// `render2mpeg cost`: what accuracy costs, and what it buys.
namespace render2mpeg::test {
namespace {

/// Small enough for a test; the room's last second is dear to nobody.
const std::string brief = " --size 32x32 --samples 1 --exposure 0 --sample 1x2";

json cost_of(const std::string& scene, const std::string& options) {
    const Folder folder;
    const auto outcome = run(program() + " cost " + scene + options + " --quiet --json " + path(folder, "c.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "");
    return json::parse(contents(folder / "c.json"));
}

/// Without what a clock says.
json timeless(json value) {
    if (value.is_object())
        for (const char* key : {"seconds", "light_seconds", "code_seconds", "summary", "command", "cpu", "clock",
                                "recommended", "time_share", "render"})
            value.erase(key);
    if (value.is_structured())
        for (json& part : value) part = timeless(part);
    // Rows come in the order of their times.
    if (value.is_object() && value.contains("film") && value.at("film").is_array())
        std::sort(value["film"].begin(), value["film"].end());
    return value;
}

/// Null where nothing differs.
double decibels(const json& psnr) {
    return psnr.is_null() ? std::numeric_limits<double>::infinity() : psnr.get<double>();
}

TEST(CostOptions, AreReadAndRefused) {
    EXPECT_EQ(app::percents_from("2,16,0.5,2"), (std::vector<float>{0.16f, 0.02f, 0.005f}));
    EXPECT_EQ(app::percents_from("0.001"), (std::vector<float>{1e-5f})) << "the least";
    EXPECT_EQ(app::quantisers_from("31,2,2,8"), (std::vector<int>{2, 8, 31}));
    EXPECT_TRUE(app::quantisers_from("none").empty());
    for (const char* wrong : {"", "2,", "0", "101", "-1", "2%", "x", "nan", "1e-50", "0.0009"})
        EXPECT_THROW(app::percents_from(wrong), core::Error) << wrong;
    for (const char* wrong : {"", "2,", "0", "32", "4.5", "none,2"})
        EXPECT_THROW(app::quantisers_from(wrong), core::Error) << wrong;
    for (const char* wrong : {"", "2", "x3", "0x3", "2x0", "1001x1", "2x3x4"})
        EXPECT_THROW(app::sample_from(wrong), core::Error) << wrong;

    const Folder folder;
    const auto refused = [&](const std::string& options, const char* words) {
        const auto outcome = run(program() + " cost " + plain_film() + brief + options);
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    refused(" --sample 3", "WINDOWSxFRAMES");
    refused(" --bitrate 6M", "--bitrate");
    refused(" --json " + plain_film() + "/film.json", "it is an input");
    refused(" --report " + path(folder, "r.pdf"), ".html");
    refused(" --report " + path(folder, "r.html") + " --json " + path(folder, "r.report.json"), "two outputs");
}

TEST(Cost, RisesAndErrorsFallAsTolerancesTightenSlow) {
    const json found = cost_of(support::panel_film(), brief + " --tolerances 0.001,2,40 --quantiser 31");
    EXPECT_TRUE(found.at("complete").get<bool>());
    EXPECT_EQ(found.at("windows"), (json{{29, 30}}));
    EXPECT_EQ(found.at("reference").at("frames"), 1);
    EXPECT_EQ(found.at("cache"), "static");
    EXPECT_EQ(found.at("masking"), "warped");
    const json& rows = found.at("rows");
    ASSERT_EQ(rows.size(), 7u);
    const std::vector<std::string> names{"fixed=40%", "fixed=2%", "fixed=0.001%", "coupled", "draft", "low", "high"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        EXPECT_EQ(rows[i].at("name"), names[i]);
        EXPECT_GT(rows[i].at("light_seconds").get<double>(), 0.0);
        EXPECT_EQ(rows[i].at("requantised"), 0);
        EXPECT_EQ(rows[i].at("error_pixels"), 1008) << "all but the lamp's";
        if (i == 0 || i > 2) continue;
        EXPECT_GT(rows[i].at("rays_per_point"), rows[i - 1].at("rays_per_point"));
        EXPECT_GT(rows[i].at("cut"), rows[i - 1].at("cut"));
        EXPECT_LT(rows[i].at("error_p95"), rows[i - 1].at("error_p95"));
    }

    EXPECT_LT(rows[3].at("rays_per_point").get<double>(), 0.7 * rows[1].at("rays_per_point").get<double>())
        << "coarse coding hides much";

    // Decibels are against the truth, by paths of one pixel in sixteen.
    const json& truth = found.at("truth");
    EXPECT_EQ(truth.at("pixels"), 63);
    EXPECT_EQ(truth.at("of_pixels"), 1008);
    EXPECT_GT(decibels(rows[2].at("lit_psnr_y")), truth.at("psnr_y").get<double>() - 0.1);
    EXPECT_GT(truth.at("seconds").get<double>(), 0.0);
    EXPECT_GT(truth.at("psnr_y").get<double>(), 20.0);
    const json& film = found.at("film");
    EXPECT_EQ(std::count_if(film.begin(), film.end(), [](const json& row) { return row.at("value") == "truth"; }), 1);
}

TEST(Cost, OfAllLightPointsLeavesWhatTheyMissSlow) {
    const json found =
        cost_of(support::panel_film(), brief + " --indirect lightcuts --vpls 16 --tolerances 0.001 --quantiser 31");
    const json& row = found.at("rows")[0];
    // What is tried and what it is held against are lit by the same points; decibels are against the truth.
    EXPECT_LT(row.at("error_p95").get<double>(), 1e-3);
    EXPECT_LT(row.at("error_p99").get<double>(), 6e-3) << "where it is nearly black";
    EXPECT_LT(row.at("cut").get<double>(), found.at("light_points").get<double>() + 1);
    EXPECT_LT(decibels(row.at("lit_psnr_y")), 45.0) << "65 and more against light of the same 16 points";
}

TEST(Cost, DependsOnThreadsInItsTimesAloneSlow) {
    const std::string options = brief + " --tolerances 10 --quantiser 8 --b-pictures 0";
    EXPECT_EQ(timeless(cost_of(plain_film(), options + " --threads 1")),
              timeless(cost_of(plain_film(), options + " --threads 3")));
}

TEST(Cost, OfWhatIsBlackIsToldSlow) {
    const json found = cost_of(plain_film(),
                               " --size 16x16 --samples 1 --exposure -40 --sample 1x1"
                               " --tolerances 16");
    EXPECT_TRUE(found.at("rows")[0].at("psnr_y").is_null()) << "the same to the last bit";
    EXPECT_NE(found.at("summary").get<std::string>().find("none you can see"), std::string::npos);
}

TEST(Cost, OfASceneWithoutAnythingToLightIsToldSlow) {
    const Folder folder;
    std::ofstream(folder / "film.json") << R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
        "objects": [{"name": "away", "shape": "box", "position": [0, 0, 50], "material": "grey"}],
        "materials": {"grey": {"base_color": 0.5}}})";
    const auto outcome = run(program() + " cost " + path(folder, "film.json") + brief + " --report " +
                             path(folder, "c.html") + " --tolerances 4,2");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("none you can see"), std::string::npos) << outcome.output;
    const json found = json::parse(contents(folder / "c.report.json"));
    EXPECT_EQ(found.at("rows")[0].at("points"), 0);
    EXPECT_EQ(found.at("rows")[0].at("error_pixels"), 0);
    EXPECT_TRUE(found.at("truth").is_null());
}

TEST(Cost, PrintsRowsThatFitATerminalAndAPageThatStandsAloneSlow) {
    const Folder folder;
    const std::string command =
        program() + " cost " + plain_film() + brief + " --tolerances 32,16,4,1 --report " + path(folder, "c.html");
    const auto outcome = run(command);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with(plain_film()) && !line.starts_with(program())) {
            EXPECT_LE(line.size(), 80u) << line;
        }
    std::string words = outcome.output;
    std::replace(words.begin(), words.end(), '\n', ' ');
    EXPECT_NE(words.find("SSIM, HVS-M and errors of light: against this light itself."), std::string::npos) << words;
    for (const char* row : {"\nfixed=32%  ", "\nfixed=4%  ", "\ncoupled  ", "\neffort low  ", "\ntruth  "})
        EXPECT_NE(outcome.output.find(row), std::string::npos) << outcome.output;

    const std::string page = contents(folder / "c.html");
    const json found = json::parse(contents(folder / "c.report.json"));
    test::expect_alone(page);
    EXPECT_EQ(test::page_data(page).at("figures"), found);
    for (const json& cost : test::page_data(page).at("without"))
        EXPECT_TRUE(test::page_data(page).at("wholes").contains(std::to_string(cost.at("frame").get<int>())));

    // Such a page may be replaced, and nothing else.
    const std::string again = program() + " cost " + plain_film() + brief + " --tolerances 50 --quiet";
    EXPECT_EQ(run(again + " --report " + path(folder, "c.html")).status, 0);
    EXPECT_EQ(contents(folder / "c.html").find("fixed=32%"), std::string::npos);
    std::ofstream(folder / "other.html") << "mine";
    EXPECT_EQ(run(again + " --report " + path(folder, "other.html")).status, 1);
    EXPECT_EQ(contents(folder / "other.html"), "mine");
}

TEST(Truth, MendsWhatIsMeasuredAgainstReferenceLight) {
    // A reference that is 2 code values too dark in three pixels of four, whose truth is known with noise of 1.
    app::ReferenceFrame reference;
    reference.picture.y = core::Plane<std::uint8_t>(8, 8, 100);
    core::Plane<std::uint8_t> luma(8, 8, 105);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            if (x % 4 != 0) reference.gathering.push_back({x, y});
    EXPECT_DOUBLE_EQ(reference.mean_squared_error(luma), 25.0);
    for (int i = 0; i < 4; ++i)
        reference.truth.push_back({reference.gathering[static_cast<std::size_t>(5 * i)], {3, 1}});
    // (5 - 3)(5 - 1) in place of 25 in three of four pixels.
    EXPECT_DOUBLE_EQ(reference.mean_squared_error(luma), 0.25 * 25 + 0.75 * 8);
    luma = core::Plane<std::uint8_t>(8, 8, 102);
    reference.gathering.resize(64);
    EXPECT_DOUBLE_EQ(reference.mean_squared_error(luma), 0.0) << "not below";
}

app::RenderJob tiny_film(const std::string& input = plain_film(), const std::string& size = "32x32") {
    app::RenderOptions options;
    options.input = input;
    options.size = app::size_from(size);
    options.samples = 1;
    options.exposure = 0.0f;
    return app::prepare(options);
}

TEST(Trials, CountPicturesThatABufferHasNoRoomForSlow) {
    app::RenderJob film = tiny_film();
    for (const bool tight : {false, true}) {
        // The smallest buffer that a header can tell.
        film.coding.rate_control.buffer_bits = tight ? 16384 : 0;
        film.coding.rate_control.max_rate = tight ? 12000 : 0;
        app::Trials trials(film, app::middle_windows(film, 1, 10), 0);
        ASSERT_TRUE(trials.light_references([](double) {}, [] { return true; }));
        app::LitWindows lit;
        const app::RenderJob coarse =
            app::at_quantiser(app::with_tolerance(trials.film(), app::fixed_tolerance(0.5f)), 1);
        const auto trial = trials.run(
            coarse, [] { return true; }, &lit);
        ASSERT_TRUE(trial);
        EXPECT_EQ(trial->requantised > 0, tight) << trial->bytes;
        EXPECT_LE(trial->requantised, trial->frames);
        EXPECT_EQ(trials.coded_again(lit, coarse).requantised, trial->requantised);
    }
}

TEST(Trials, GiveCoupledLightTheShareThatTheyAreAskedForSlow) {
    const app::RenderJob film = tiny_film(support::panel_film());
    app::Trials trials(film, app::middle_windows(film, 1, 2), 0);
    ASSERT_TRUE(trials.light_references([](double) {}, [] { return true; }));
    EXPECT_EQ(trials.references(), 0);
    const auto rays = [&](std::optional<float> share) {
        const app::RenderJob coupled = app::with_tolerance(trials.film(), {false, 0, true, share});
        return trials.run(app::at_quantiser(coupled, 8), [] { return true; })->rays;
    };
    EXPECT_LT(rays(8.0f), 0.7 * rays({})) << "the usual share is less than a tenth of it";
}

TEST(Trials, TellTheirMemoryBeforeTheyTakeIt) {
    const app::RenderJob film = tiny_film();
    const app::Trials few(film, app::middle_windows(film, 2, 3)), many(film, app::middle_windows(film, 2, 20));
    EXPECT_EQ(few.bytes_held(false), many.bytes_held(false)) << "references alone";
    EXPECT_NEAR((many.bytes_held(true) - few.bytes_held(true)) / (34 * 32 * 32), 40, 5);
    EXPECT_NO_THROW(app::check_memory(3.21e9, 8e9));
    EXPECT_THROW(app::check_memory(8.1e9, 8e9), core::Error);
}

TEST(Trials, EndWhenTheyAreToldToSlow) {
    const app::RenderJob film = tiny_film(plain_film(), "8x8");
    app::Trials trials(film, app::middle_windows(film, 2, 2));
    int told = 0, done = 0;
    EXPECT_FALSE(trials.light_references(
        [&](double seconds) {
            ++told;
            EXPECT_GT(seconds, 0);
        },
        [&] { return ++done < 1; }));
    EXPECT_EQ(told, 1);
    EXPECT_EQ(done, 1);
    ASSERT_TRUE(trials.light_references([](double) {}, [] { return true; }));
    EXPECT_EQ(trials.references(), 2);
    int frames = 0;
    const app::RenderJob coarse = app::with_tolerance(trials.film(), app::fixed_tolerance(0.3f));
    EXPECT_FALSE(trials.run(coarse, [&] { return ++frames < 2; })) << "in the midst";
    EXPECT_EQ(frames, 2);
    EXPECT_TRUE(trials.run(coarse, [] { return true; })) << "nothing is left of it";
}

}  // namespace
}  // namespace render2mpeg::test
