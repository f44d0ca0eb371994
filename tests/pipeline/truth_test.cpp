#include <gtest/gtest.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "support/program.h"

/// `--tolerance truth`.
namespace render2mpeg::app {
namespace {

support::Outcome render(const std::string& output, const std::string& options) {
    return support::run(support::program() + " render -y --hold " + support::panel_film() +
                        " --frames 0:1 --size 8x8 --tolerance truth=20% -o " + output + " " + options);
}

TEST(Truth, MakesFilmsAndFramesAndTellsItsPathsSlow) {
    const support::Folder folder;
    for (const char* name : {"a.mpg", "f.%04d.exr"}) {
        const std::string stats = (folder / "s.json").string();
        const support::Outcome outcome = render((folder / name).string(), "--stats " + stats);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        const nlohmann::json written = nlohmann::json::parse(support::contents(stats));
        EXPECT_EQ(written.at("tolerance").at("mode"), "truth");
        EXPECT_EQ(written.at("counts").at("true_pixels"), 128);
        EXPECT_GE(written.at("counts").at("true_paths"), 128 * 160);
    }
}

TEST(Truth, RefusesWhatPathsDoNotKnow) {
    const support::Folder folder;
    const std::string output = (folder / "a.mpg").string();
    for (const char* options : {"--audit 5", "--shutter 180", "--preview", "--heatmap reuse h.mpg"}) {
        const support::Outcome outcome = render(output, options);
        EXPECT_NE(outcome.status, 0) << options;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    }
    const support::Outcome unused = render(output, "--vpls 100");
    EXPECT_EQ(unused.status, 0);
    EXPECT_NE(unused.output.find("--vpls does nothing here"), std::string::npos) << unused.output;
}

}  // namespace
}  // namespace render2mpeg::app
