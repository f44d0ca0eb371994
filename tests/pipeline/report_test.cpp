#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "pipeline/fixture.h"

/// --report: a page that stands alone, and its figures beside it.
namespace render2mpeg::test {
namespace {

TEST(Report, IsOnePageThatStandsAloneAndItsFiguresAreTheStatisticsSlow) {
    const Folder folder;
    const std::string output = "'" + path(folder, "a&b<i>.mpg") + "'";
    const auto outcome = run(program() + " render -y --hold " + plain_film() +
                             " --size 48x32 --samples 1 --frames 3:13 --quiet --audit 5 -o " + output + " --report " +
                             path(folder, "r.html") + " --stats " + path(folder, "s.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const std::string html = contents(folder / "r.html");

    test::expect_alone(html);
    EXPECT_EQ(html.find("<i>"), std::string::npos) << "names are text";
    const json page = test::page_data(html), report = json::parse(contents(folder / "r.report.json"));
    EXPECT_EQ(page.at("title"), "a&b<i>.mpg");
    EXPECT_EQ(page.at("lead"), report.at("summary"));
    EXPECT_TRUE(report.at("summary").get<std::string>().starts_with("11 frames of 48x32 took "));

    // A value for every frame in each of the plots; the first picture is an I picture.
    for (const auto& [key, values] : page.at("frames").items()) EXPECT_EQ(values.size(), 11u) << key;
    EXPECT_EQ(page.at("frames").at("frame")[0], 3);
    EXPECT_EQ(page.at("frames").at("type")[0], "I");
    const json statistics = json::parse(contents(folder / "s.json"));
    EXPECT_EQ(page.at("frames").at("bytes")[0], statistics.at("per_frame")[0].at("bytes"));

    for (const auto& [key, value] : statistics.items()) {
        ASSERT_TRUE(report.contains(key)) << key;
        if (key != "seconds" && key != "peak_rss_mib") {
            EXPECT_EQ(report.at(key), value) << key;
        }
    }
    // What the picture consists of: each effect once, and together no more than there was.
    std::string effects;
    double seconds = 0;
    for (const json& row : statistics.at("effects")) {
        effects += row.at("effect").get<std::string>() + ", ";
        if (row.at("seconds").is_number()) seconds += row.at("seconds").get<double>();
    }
    EXPECT_EQ(effects, "seeing, direct light, bounced light, what the eye misses, motion, coding, ")
        << "the box has neither mirrors nor glass";
    const double audit = statistics.at("audit").at("seconds").get<double>();
    EXPECT_GT(seconds, 0.2 * (statistics.at("seconds").at("cpu").get<double>() - audit));
    EXPECT_LT(seconds, statistics.at("seconds").at("cpu").get<double>());
    ASSERT_EQ(page.at("pictures").size(), 3u) << "a pair, tolerances, and errors";
    EXPECT_EQ(page.at("pictures")[0].at("names"), json({"decoded", "as it was lit", "difference"}));
    for (const json& source : page.at("pictures")[0].at("sources"))
        EXPECT_TRUE(source.get<std::string>().starts_with("data:image/png;base64,"));

    const auto exposure = std::find_if(report.at("plan").begin(), report.at("plan").end(),
                                       [](const json& row) { return row.at("pass") == "exposure"; });
    ASSERT_NE(exposure, report.at("plan").end());
    EXPECT_EQ(exposure->at("runs"), true) << "it was measured";
    EXPECT_GE(report.at("plan").size(), 20u);
}

TEST(Report, OfFramesThatAreNotCodedSpeaksOfLightAlone) {
    const Folder folder;
    ASSERT_EQ(run(program() + " render -y --hold " + plain_film() +
                  " --size 32x32 --samples 1 --exposure 0 --frames 0:1 --quiet -o " + path(folder, "f.%d.exr") +
                  " --report " + path(folder, "r.html"))
                  .status,
              0);
    const json page = test::page_data(contents(folder / "r.html"));
    EXPECT_FALSE(page.at("figures").contains("rate")) << "plots of coding need it";
    EXPECT_EQ(page.at("text").get<std::string>().find("PSNR"), std::string::npos);
}

TEST(Report, IsRefusedUnderNamesThatWouldNotDo) {
    const Folder folder;
    const std::string start =
        program() + " render -y --hold " + plain_film() + " --dry-run --within 0 -o " + path(folder, "x.mpg");
    const auto refused = [&](const std::string& options, const char* words) {
        const auto outcome = run(start + options);
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
    };
    refused(" --report " + path(folder, "r.pdf"), ".html");
    refused(" --report " + path(folder, "r.html") + " --stats " + path(folder, "r.report.json"), "two outputs");
}

}  // namespace
}  // namespace render2mpeg::test
