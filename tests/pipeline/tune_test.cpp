#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "app/experiments/experiments.h"
#include "app/experiments/trial.h"
#include "app/experiments/tuning.h"
#include "app/options/option_text.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "core/text.h"
#include "perceptual/metrics.h"
#include "pipeline/fixture.h"

/// `render2mpeg tune`: from a quality, a rate, a size or a time to a setting, and to the film.
namespace render2mpeg::test {
namespace {

using app::QualitySearch;
using app::Target;

const std::string small_search = " --samples 1 --exposure 0 --size 32x32",
                  smallest_search = " --samples 1 --exposure 0 --size 16x16";

/// Probes until nothing is left to be tried or the figure is within `near` of the target; counts them.
int probes_until(QualitySearch& search, double target, double near, double first,
                 const std::function<double(double)>& figure) {
    search.add(first, figure(first));
    int probes = 1;
    while (std::abs(search.nearest().figure - target) > near) {
        const auto next = search.next();
        if (!next) break;
        EXPECT_GE(*next, 0.0);
        EXPECT_LE(*next, 100.0);
        for (const QualitySearch::Known& k : search.known())
            EXPECT_GT(std::abs(k.quality - *next), 0.5 * QualitySearch::step) << "probed twice";
        search.add(*next, figure(*next));
        if (++probes > 30) break;
    }
    return probes;
}

TEST(QualitySearch, MeetsATargetOnSmoothCurvesInFewProbes) {
    const auto bent = [](double q) { return 25 + 0.12 * q + 0.0012 * q * q; };
    const auto straight = [](double q) { return 20 + 0.3 * q; };
    const auto flattening = [](double q) { return 48 - 25 * std::exp(-q / 40); };
    for (const auto& film : {std::function<double(double)>(bent), std::function<double(double)>(straight),
                             std::function<double(double)>(flattening)})
        for (const double share : {0.05, 0.3, 0.6, 0.9}) {
            const double target = film(0) + share * (film(100) - film(0));
            QualitySearch search(target);
            EXPECT_LE(probes_until(search, target, 0.04, 60, film), 10) << target;
            EXPECT_NEAR(search.nearest().figure, target, 0.04);
        }
}

TEST(QualitySearch, FindsTheStepsBesideATargetThatLiesBetween) {
    const auto steps = [](double q) { return 30 + 4.0 * std::floor((q + 3) / 20); };
    QualitySearch search(40);
    EXPECT_LE(probes_until(search, 40, 0.1, 60, steps), 16);
    ASSERT_TRUE(search.coarsest_above() && search.finest_below());
    EXPECT_NEAR(search.coarsest_above()->quality, 57, 0.2);
    EXPECT_EQ(search.coarsest_above()->figure, 42);
    EXPECT_EQ(search.finest_below()->figure, 38);
    EXPECT_FALSE(search.next()) << "they are neighbours";
}

TEST(QualitySearch, EndsAtTheFinestAndAtTheCoarsest) {
    const auto film = [](double q) { return 30 + 0.1 * q; };
    for (const double target : {50.0, 20.0}) {
        QualitySearch search(target);
        EXPECT_LE(probes_until(search, target, 0.01, 60, film), 6);
        EXPECT_FALSE(search.next());
        EXPECT_EQ(search.nearest().quality, target > 40 ? 100 : 0);
    }
    EXPECT_FALSE(QualitySearch(40).next()) << "nothing is known";
}

TEST(TuneTargets, AreReadAndRefused) {
    EXPECT_EQ(app::size_in_bytes("700M"), 700e6);
    EXPECT_EQ(app::size_in_bytes("4.7GB"), 4.7e9);
    EXPECT_EQ(app::size_in_bytes("25k"), 25e3);
    EXPECT_EQ(app::size_in_bytes("1234"), 1234);
    for (const char* wrong : {"", "M", "-3", "1T", "3 MB", "0", "nan", "1e30"})
        EXPECT_THROW(app::size_in_bytes(wrong), core::Error) << wrong;
    EXPECT_EQ(app::time_in_seconds("2h"), 7200);
    EXPECT_EQ(app::time_in_seconds("1h30m"), 5400);
    EXPECT_EQ(app::time_in_seconds("1h30m10"), 5410);
    EXPECT_EQ(app::time_in_seconds("45s"), 45);
    EXPECT_EQ(app::time_in_seconds("0.5h"), 1800);
    for (const char* wrong : {"", "h", "1m2h", "-1h", "0s", "3d", "1h1h", "nan"})
        EXPECT_THROW(app::time_in_seconds(wrong), core::Error) << wrong;

    const auto refused = [&](const std::string& options, const char* words) {
        const auto outcome = run(program() + " tune " + plain_film() + small_search + options);
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    refused(" --dry-run", "Give one of");
    refused(" --target-psnr 40 --target-ssim 0.9 --dry-run", "Give one of");
    refused(" --target-psnr 40", "which film");
    refused(" --target-psnr 40 --quality 50 --dry-run", "it is what is looked for");
    refused(" --target-psnr 40 -o /tmp/x.y4m", "is not coded");
    refused(" --max-size 0 --dry-run", "max-size");
    refused(" --target-psnr 40 --dry-run --json " + plain_film() + "/film.json", "it is an input");
    // Inputs are told of before consent, and folders are made last.
    const Folder folder;
    const std::string list = path(folder, "list.mpg"), page = path(folder, "new/page.html");
    std::ofstream(list) << "0,2";
    refused(" --target-psnr 40 --keyframes " + list + " -o " + list, "it is an input");
    refused(" --target-psnr 40 -y --keyframes " + list + " -o " + list + " --report " + page, "it is an input");
    refused(" --target-psnr 40 --dry-run --report " + page, "there is no folder");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(TuneTargets, AreNearWithinWhatIsPromised) {
    EXPECT_TRUE(app::is_near({Target::Kind::psnr, 40}, 40.1 - 1e-9));
    EXPECT_FALSE(app::is_near({Target::Kind::psnr, 40}, 39.89));
    EXPECT_FALSE(app::is_near({Target::Kind::psnr, 40}, 40.05, 0.4));
    EXPECT_TRUE(app::is_near({Target::Kind::ssim, 0.95}, 0.9481));
    EXPECT_FALSE(app::is_near({Target::Kind::ssim, 0.95}, 0.9479));
    EXPECT_TRUE(app::is_near({Target::Kind::bitrate, 1e6}, 1.019e6));
    EXPECT_FALSE(app::is_near({Target::Kind::bitrate, 1e6}, 0.979e6));
    EXPECT_TRUE(std::isfinite(app::even_figure({Target::Kind::ssim, 0.9}, 1.0)));
    EXPECT_TRUE(std::isfinite(app::even_figure({Target::Kind::bitrate, 1}, 0.0)));
}

TEST(QualityWithLight, IsThatOfAllPicturesWhateverTheFewAre) {
    const double infinite = std::numeric_limits<double>::infinity();
    // Light adds an error of 1 to pictures whose coding errs by 4 on average, and by 1 or 16 in those that are known.
    const auto psnr = [](double error) { return perceptual::psnr(error); };
    for (const double there : {1.0, 4.0, 16.0}) {
        const app::Quality q = app::with_light({psnr(4), 0.9, psnr(4)}, {psnr(there), 0.9 + 0.001 * there, psnr(there)},
                                               {psnr(there + 1), 0.88 + 0.001 * there, psnr(there + 1)});
        EXPECT_NEAR(q.psnr_y, psnr(5), 1e-9);
        EXPECT_NEAR(q.ssim_y, 0.88, 1e-12);
        EXPECT_NEAR(q.psnr_hvs_m, psnr(5), 1e-9);
    }
    // Nothing lost is nothing lost, and light alone is light alone.
    EXPECT_EQ(app::with_light({infinite, 1, infinite}, {infinite, 1, infinite}, {infinite, 1, infinite}).psnr_y,
              infinite);
    EXPECT_NEAR(app::with_light({infinite, 1, infinite}, {infinite, 1, infinite}, {40, 0.9, 41}).psnr_y, 40, 1e-9);
    EXPECT_EQ(app::with_light({50, 1, 50}, {40, 1, 40}, {infinite, 1, infinite}).psnr_y, infinite) << "never below 0";
}

TEST(CommandWords, BecomeThoseOfTheRender) {
    const std::vector<std::string> words{"./r",    "tune",         "a b.glb",      "--target-psnr",
                                         "40",     "--size=32x32", "--sample=1x3", "--dry-run",
                                         "--json", "x.json",       "--vpls",       "16"};
    EXPECT_EQ(app::line_of(app::changed_command(words, "render", {"--target-psnr", "--sample", "--json"}, {"--dry-run"},
                                                {{"--quality", "63.4"}, {"-o", "f.mpg"}})),
              "./r render 'a b.glb' --size=32x32 --vpls 16 --quality 63.4 -o f.mpg");
}

json tuned(const std::string& options, int status = 0, const std::string& search = small_search) {
    const Folder folder;
    const auto outcome =
        run(program() + " tune " + plain_film() + search + options + " --quiet --json " + path(folder, "t.json"));
    EXPECT_EQ(outcome.status, status) << outcome.output;
    return json::parse(contents(folder / "t.json"));
}

TEST(Tune, FindsAQualityAndPrintsTheRenderThatHasItSlow) {
    const Folder folder;
    const std::string options = small_search + " --sample 2x6 --target-psnr 38 --dry-run";
    const auto outcome = run(program() + " tune " + plain_film() + options + " --report " + path(folder, "t.html") +
                             " --json " + path(folder, "t.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const json found = json::parse(contents(folder / "t.json"));
    EXPECT_EQ(json::parse(contents(folder / "t.report.json")), found);
    const json& chosen = found.at("rows").at(found.at("chosen").get<std::size_t>());
    EXPECT_TRUE(chosen.at("lit").get<bool>()) << "light is coupled to the very coding that is taken";
    EXPECT_EQ(chosen.at("psnr_y"), chosen.at("value"));
    if (found.at("found") == "near") {
        EXPECT_NEAR(chosen.at("value").get<double>(), 38, 0.1);
    } else {
        EXPECT_EQ(found.at("found"), "between");
        EXPECT_GT(chosen.at("value").get<double>(), 38);
    }
    const std::string command = found.at("render").get<std::string>();
    EXPECT_NE(command.find(" render "), std::string::npos);
    EXPECT_NE(command.find("--quality " + chosen.at("setting").get<std::string>()), std::string::npos) << command;
    EXPECT_EQ(command.find("--target"), std::string::npos) << command;
    EXPECT_TRUE(found.at("film").is_null());
    EXPECT_NE(outcome.output.find("\n" + command + "\n"), std::string::npos) << "a line to paste";

    // A row for every probe, as wide as a terminal.
    std::istringstream lines(outcome.output);
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with(plain_film()) && line != command) {
            EXPECT_LE(line.size(), 80u) << line;
        }
        for (const json& probe : found.at("rows"))
            if (line.find(" " + probe.at("setting").get<std::string>() + " ") ==
                9u - probe.at("setting").get<std::string>().size() - 1)
                ++rows;
    }
    EXPECT_GE(rows, found.at("rows").size());
    const std::string page = contents(folder / "t.html");
    EXPECT_NE(page.find(app::line_of({"--quality", chosen.at("setting").get<std::string>()})), std::string::npos);
    EXPECT_EQ(test::page_data(page).at("figures"), found);
    const std::string document = contents(support::source_folder() / "docs/json.md");
    for (const auto& [key, value] : found.items()) EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    for (const auto& [key, value] : chosen.items()) EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
}

TEST(Tune, SaysWhatIsOutOfReachSlow) {
    const json fine = tuned(" --sample 1x2 --target-psnr 90 --dry-run", 1, smallest_search);
    EXPECT_EQ(fine.at("found"), "beyond");
    EXPECT_EQ(fine.at("rows").at(fine.at("chosen").get<std::size_t>()).at("setting"), "100.0");
    EXPECT_TRUE(fine.at("render").is_null());
    const json much = tuned(" --sample 1x2 --tolerance fixed=20% --target-bitrate 90M --dry-run", 0, smallest_search);
    EXPECT_EQ(much.at("found"), "between") << "the finest film is delivered";
    EXPECT_EQ(much.at("options").at("quality"), "100.0");
    const json late = tuned(" --sample 1x1 --max-time 0.001s --dry-run", 1, smallest_search);
    EXPECT_EQ(late.at("found"), "beyond");
    EXPECT_EQ(late.at("rows").size(), 2u) << "as asked for, and the least";
}

TEST(Tune, LoosensNoOptionThatIsIdleSlow) {
    for (const bool points : {false, true}) {
        const auto outcome =
            run(program() + " tune " + plain_film() + " --size 16x16 --exposure 0 --indirect " +
                (points ? "lightcuts" : "rays") + " --vpls 256 --sample 1x1 --max-time 0.001s --dry-run");
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        EXPECT_EQ(outcome.output.find("samples 1, vpls 64") != std::string::npos, points) << outcome.output;
        EXPECT_NE(outcome.output.find("samples 1"), std::string::npos) << outcome.output;
    }
}

TEST(Tune, MakesAFilmOfItsRateAndLooksAtItSlow) {
    const Folder folder;
    const json found =
        tuned(" --sample 1x6 --frames 0:29 --tolerance fixed=10% --target-bitrate 40k -o " + path(folder, "f.mpg"));
    EXPECT_EQ(found.at("reference").at("frames"), 0) << "a rate needs none";
    EXPECT_EQ(found.at("options").at("bitrate"), "40000");
    const json& film = found.at("film");
    EXPECT_EQ(film.at("frames"), 30);
    EXPECT_EQ(film.at("bytes"), static_cast<double>(std::filesystem::file_size(folder / "f.mpg")));
    EXPECT_NEAR(film.at("bit_rate").get<double>(), 40e3, 0.02 * 40e3);
    EXPECT_TRUE(film.at("near").get<bool>());
}

TEST(Tune, KeepsAFileBelowItsSizeSlow) {
    for (const char* ending : {"mpg", "ts"}) {
        const double most = ending[0] == 't' ? 12e3 : 6e3;
        const Folder folder;
        const std::string name = std::string("f.") + ending;
        const json found = tuned(" --sample 1x3 --frames 0:29 --tolerance fixed=20% --max-size " +
                                 std::to_string(most) + " -o " + path(folder, name));
        const auto size = static_cast<double>(std::filesystem::file_size(folder / name));
        EXPECT_LE(size, most) << name;
        EXPECT_GT(size, 0.6 * most) << name;
        EXPECT_EQ(found.at("film").at("bytes"), size);
    }
}

TEST(Tune, HoldsAFileToASizeThatItsSampleDoesNotFill) {
    // Far more than the finest film needs: still a rate, which the whole film keeps whatever its sample is.
    // The sample says nothing of how much more that may need: the size decides, or the highest rate of the level.
    const auto rate_of = [](const std::string& size) {
        const json found =
            tuned(" --sample 1x3 --frames 0:29 --tolerance fixed=20% --dry-run --max-size " + size, 0, smallest_search);
        EXPECT_EQ(found.at("found"), "between");
        EXPECT_EQ(found.at("rows").at(found.at("chosen").get<std::size_t>()).at("setting"), "100.0");
        EXPECT_NE(found.at("summary").get<std::string>().find("the finest film needs no more"), std::string::npos);
        return std::stod(found.at("options").at("bitrate").get<std::string>());
    };
    const double seconds = 30 / 25.0;
    const double bytes = rate_of("2M") * seconds / 8;
    EXPECT_LT(bytes, 2e6);
    EXPECT_GT(bytes, 0.9 * 2e6);
    EXPECT_EQ(rate_of("3M"), 15e6) << "Main level [H262, table 8-12]";
    EXPECT_EQ(rate_of("3M --maxrate 5M"), 5e6);
}

TEST(Tune, SaysWhereNothingIsLostWhateverTheQualitySlow) {
    const Folder folder;
    const auto outcome = run(program() + " tune " + plain_film() +
                             " --size 16x16 --samples 1 --exposure -60 --sample 1x2 --target-psnr 40 "
                             "--dry-run --json " +
                             path(folder, "t.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("nothing is lost on the sample whatever the quality"), std::string::npos)
        << outcome.output;
    const json found = json::parse(contents(folder / "t.json"));
    EXPECT_EQ(found.at("found"), "between");
    EXPECT_EQ(found.at("options").at("quality"), "0.0") << "the smallest";
}

TEST(Tune, LoosensLightUntilItIsInTimeSlow) {
    const json easy = tuned(" --sample 1x1 --max-time 10h --quantiser 8 --dry-run", 0, smallest_search);
    EXPECT_EQ(easy.at("rows").size(), 1u);
    EXPECT_TRUE(easy.at("options").empty()) << "nothing need be loosened";
    EXPECT_LT(easy.at("rows")[0].at("value").get<double>(), 36000);
    EXPECT_GT(easy.at("rows")[0].at("value").get<double>(), 0);
    EXPECT_NE(easy.at("render").get<std::string>().find("--quantiser 8"), std::string::npos);
}

TEST(Tune, MakesTheFilmAgainWhereItMissedSlow) {
    std::vector<std::string> words{"render2mpeg", "tune", plain_film(), "--target-psnr", "36",     "--references", "0",
                                   "--frames",    "0:3",  "-o",         "never.mpg",     "--quiet"};
    const std::string search = smallest_search.substr(1);
    for (const std::string_view word : core::words_in(search)) words.emplace_back(word);
    const app::CommandLine line = app::parse(words);
    std::vector<double> qualities;
    // A film that is 0.6 dB below its sample, and gains 0.2 dB with each step of quality.
    const auto make = [&](const app::RenderOptions& options, const std::string&, app::Rendered* rendered) {
        qualities.push_back(*options.coding.quality);
        const double psnr = 35.4 + 0.2 * (qualities.back() - qualities.front());
        rendered->statistics.frames.resize(4);
        for (app::FrameEntry& frame : rendered->statistics.frames) frame.mse_y = 255 * 255 / std::pow(10, psnr / 10);
        return 0;
    };
    EXPECT_EQ(app::tune(line.trial, line.words, make), 0);
    ASSERT_EQ(qualities.size(), 2u);
    EXPECT_NEAR(qualities[1] - qualities[0], 3, 0.11);
    // One that no quality helps is given up: the finest is made once.
    qualities.clear();
    const auto deaf = [&](const app::RenderOptions& options, const std::string& command, app::Rendered* rendered) {
        make(options, command, rendered);
        for (app::FrameEntry& frame : rendered->statistics.frames) frame.mse_y = 100;
        return 0;
    };
    EXPECT_EQ(app::tune(line.trial, line.words, deaf), 1);
    ASSERT_EQ(qualities.size(), 2u);
    EXPECT_EQ(qualities[1], 100);
}

}  // namespace
}  // namespace render2mpeg::test
