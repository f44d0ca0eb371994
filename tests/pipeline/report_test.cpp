#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/report/figures.h"
#include "pipeline/fixture.h"

/// --report: a page that stands alone, and its figures beside it.
namespace render2mpeg::test {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + word.size())) ++found;
    return found;
}

/// Names of the tags that are opened and not closed in their order; empty for text in which every tag is.
std::vector<std::string> unbalanced(const std::string& html) {
    std::vector<std::string> open;
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
        const std::size_t end = html.find('>', at);
        if (end == std::string::npos || html[at + 1] == '!') continue;
        const std::string tag = html.substr(at + 1, end - at - 1);
        const std::string name =
            tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" /", 1) - (tag[0] == '/' ? 1 : 0));
        if (tag.back() == '/') continue;
        if (tag[0] != '/')
            open.push_back(name);
        else if (!open.empty() && open.back() == name)
            open.pop_back();
        else
            return {"/" + name};
    }
    return open;
}

TEST(Report, IsOnePageThatStandsAloneAndItsFiguresAreTheStatisticsSlow) {
    const Folder folder;
    const std::string output = "'" + path(folder, "a&b<i>.mpg") + "'";
    const auto outcome =
        run(program() + " render -y --hold " + plain_film() +
            " --size 48x32 --samples 1 --indirect lightcuts --vpls 16 --frames 3:13 --quiet --audit 5 -o " + output +
            " --report " + path(folder, "r.html") + " --stats " + path(folder, "s.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const std::string html = contents(folder / "r.html");

    // The sentence comes first, and names are text.
    const json report = json::parse(contents(folder / "r.report.json"));
    const std::size_t heading = html.find("</h1>"), lead = html.find("<p class=\"lead\">");
    ASSERT_NE(lead, std::string::npos);
    EXPECT_LT(lead - heading, 10u);
    EXPECT_EQ(html.find(app::escaped(report.at("summary").get<std::string>())), lead + 16);
    EXPECT_TRUE(report.at("summary").get<std::string>().starts_with("11 frames of 48x32 took "));
    EXPECT_NE(html.find("<h1>a&amp;b&lt;i&gt;.mpg</h1>"), std::string::npos);

    EXPECT_EQ(unbalanced(html), std::vector<std::string>{});
    test::expect_alone(html);

    // A mark for every frame in each of the plots, for a desktop and for a phone; the first picture is an I picture.
    EXPECT_EQ(count(html, "<svg "), 2u * 5u);
    EXPECT_EQ(count(html, ": frame 3, "), 2u * 6u) << "two of the cut";
    EXPECT_EQ(count(html, ": frame "), 2u * 6u * 11u);
    const json statistics = json::parse(contents(folder / "s.json"));
    const auto size = statistics.at("per_frame")[0].at("bytes").get<int>();
    EXPECT_NE(html.find("<title>I: frame 3, bytes " + std::to_string(size) + "</title>"), std::string::npos);

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
    EXPECT_EQ(effects, "seeing, direct light, photons, bounced light, what the eye misses, motion, coding, ")
        << "the box has neither mirrors nor glass";
    const double audit = statistics.at("audit").at("seconds").get<double>();
    EXPECT_GT(seconds, 0.2 * (statistics.at("seconds").at("cpu").get<double>() - audit));
    EXPECT_LT(seconds, statistics.at("seconds").at("cpu").get<double>());
    EXPECT_NE(html.find("<h2>What the picture consists of</h2>"), std::string::npos);
    EXPECT_EQ(count(html, "<img "), 4u) << "decoded, as lit, their difference, tolerances";

    const auto exposure = std::find_if(report.at("plan").begin(), report.at("plan").end(),
                                       [](const json& row) { return row.at("pass") == "exposure"; });
    ASSERT_NE(exposure, report.at("plan").end());
    EXPECT_EQ(exposure->at("runs"), true) << "it was measured";
    EXPECT_GE(report.at("plan").size(), 20u);
}

TEST(Report, OfFramesThatAreNotCodedSpeaksOfLightAlone) {
    const Folder folder;
    ASSERT_EQ(run(program() + " render -y --hold " + plain_film() +
                  " --size 32x32 --samples 1 --indirect lightcuts --vpls 16 --exposure 0 --frames 0:1 --quiet -o " +
                  path(folder, "f.%d.exr") + " --report " + path(folder, "r.html"))
                  .status,
              0);
    const std::string html = contents(folder / "r.html");
    EXPECT_EQ(unbalanced(html), std::vector<std::string>{});
    EXPECT_EQ(count(html, "<svg "), 2u * 2u);
    EXPECT_EQ(html.find("PSNR"), std::string::npos);
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
