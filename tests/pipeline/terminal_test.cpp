#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "app/options/options.h"
#include "app/system/progress.h"
#include "support/program.h"

/// What a user sees while waiting, and helps that a shell gives.
namespace render2mpeg {
namespace {

using app::progress_line;
using app::Standing;
using support::Folder;
using support::program;
using support::run;

TEST(ProgressLine, FitsEveryTerminalAndTellsTheTimeToGoInAllButTheNarrowest) {
    for (const std::int64_t total : {1, 250, 100000})
        for (const double rate : {0.0, 0.004, 3.4, 250.0})
            for (int columns = 20; columns <= 200; ++columns) {
                const Standing standing{"first pass", total / 2, total, rate, 10, true, 7 / std::max(rate, 0.001)};
                const std::string line = progress_line(standing, columns, true);
                ASSERT_LE(line.size(), static_cast<std::size_t>(columns)) << line;
                ASSERT_NE(line.find(std::to_string(total / 2) + "/" + std::to_string(total)), std::string::npos)
                    << line;
                if (columns >= 60) {
                    ASSERT_NE(line.find("ETA "), std::string::npos) << line;
                }
            }
}

TEST(ProgressLine, SaysWhatIsKnown) {
    EXPECT_EQ(progress_line({"frame", 50, 250, 2.0, 25, true, 100}, 90, true),
              "2:05 in all, ETA 1:40  [#####...................] frame 50/250   20 %  2.00 frames/s");
    EXPECT_EQ(progress_line({"frame", 5, 250, 0.1, 50, true, 2450}, 1000, false),
              "41:40 in all, ETA 40:50  frame 5/250    2 %  10.0 s/frame");
    EXPECT_EQ(progress_line({"frame", 0, 250, 0, 3, true, {}}, 1000, false), "0:03 so far, ETA -  frame 0/250    0 %");
    EXPECT_EQ(progress_line({"frame", 250, 250, 2.0, 125, true, 0}, 1000, false),
              "done in 2:05  frame 250/250  100 %  2.00 frames/s");
    EXPECT_EQ(
        app::progress_json({"frame", 50, 250, 2.0, 25, true, 100}),
        R"({"work":"frame","done":50,"total":250,"seconds":25.000,"left":100.000,"whole":125.000,"activity":""})");
}

TEST(ProgressLine, OfMoreThanWasExpectedIsFull) {
    EXPECT_EQ(progress_line({"reference", 3, 2, 0, 65, false, 0}, 79, true),
              "done in 1:05  [########################] reference 3/2  100 %");
}

TEST(Wrapping, BreaksBetweenWordsAndKeepsLineEnds) {
    EXPECT_EQ(app::wrapped("one two three", 7), "one two\nthree");
    EXPECT_EQ(app::wrapped("one\ntwo three", 20), "one\ntwo three");
    EXPECT_EQ(app::wrapped("incomprehensibilities a", 5), "incomprehensibilities\na") << "words stay whole";
    EXPECT_EQ(app::wrapped("", 5), "");
}

TEST(Help, FitsEightyColumns) {
    for (const char* command : {"", "render ", "encode ", "plan ", "info ", "cost ", "tune ", "compare ", "farm ",
                                "part ", "join ", "farm-status "}) {
        const auto help = run(program() + " " + command + "--help");
        EXPECT_EQ(help.status, 0);
        std::istringstream lines(help.output);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
    }
}

/// What bash offers behind these words, the last of them unfinished.
std::set<std::string> completions(const std::string& words) {
    // A terminal would run the function with these variables set; the program is found by its whole path.
    const std::string script = ". " + (support::binary_folder() / "shell/render2mpeg.bash").string() +
                               "; COMP_WORDS=(" + program() + " " + words +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _render2mpeg; for word in "
                               "\"${COMPREPLY[@]}\"; do echo \"$word\"; done";
    const auto outcome = run("bash -c '" + script + "'");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::istringstream lines(outcome.output);
    std::set<std::string> offers;
    for (std::string line; std::getline(lines, line);) offers.insert(line);
    return offers;
}

TEST(Completion, OffersEveryCommandAndOption) {
    EXPECT_EQ(completions("\"\""),
              (std::set<std::string>{"render", "encode", "plan", "info", "cost", "tune", "compare", "farm", "part",
                                     "join", "farm-status", "watch", "--help", "--version"}));
    for (const char* command : {"render", "encode", "plan", "info", "cost", "tune", "compare", "farm", "part", "join",
                                "farm-status", "watch"}) {
        const std::set<std::string> offers = completions(std::string(command) + " --");
        std::istringstream help(run(program() + " " + command + " --help").output);
        int options = 0;
        for (std::string line; std::getline(help, line);) {
            const std::size_t at = line.find("--");
            if (!line.starts_with("  -") || at == std::string::npos) continue;
            ++options;
            EXPECT_TRUE(offers.contains(line.substr(at, line.find_first_of(" ,", at) - at))) << command << line;
        }
        EXPECT_GE(options, 2) << command;
        EXPECT_EQ(offers.size(), static_cast<std::size_t>(options)) << command;
    }
}

TEST(Completion, OffersTheValuesOfOptionsThatHaveFew) {
    using Words = std::set<std::string>;
    EXPECT_EQ(completions("render --clamp \"\""), (Words{"bounded", "none"}));
    EXPECT_EQ(completions("render --masking \"\""), (Words{"warped", "quantised"}));
    EXPECT_EQ(completions("render --tolerance \"\""), (Words{"coupled", "fixed=", "reference", "truth"}));
    EXPECT_EQ(completions("render --for d"), (Words{"dvd-ntsc", "dvd-pal"}));
    EXPECT_EQ(completions("render --tune \"\""), (Words{"psnr", "perceptual"}));
    EXPECT_EQ(completions("render --heatmap \"\""),
              (Words{"tolerance", "cut", "error", "quantiser", "records", "age", "reuse"}));
    EXPECT_EQ(completions("render --isa s"), (Words{"sse2", "sse4.2"}));
    EXPECT_EQ(completions("render --exposure \"\""), (Words{"auto"}));
    EXPECT_EQ(completions("encode --motion-convention \"\""), (Words{"blender", "nuke"}));
    EXPECT_EQ(completions("encode --fps 2"), (Words{"23.976", "24", "25", "29.97"}));
}

TEST(ManualPages, EndWithExamplesOfTheirCommand) {
    for (const std::string command : {"render", "encode", "plan", "info", "cost", "tune", "compare", "farm", "part",
                                      "join", "farm-status", "watch"}) {
        const std::string page =
            support::contents(support::binary_folder() / "shell" / ("render2mpeg-" + command + ".1"));
        const std::string begin = ".SH EXAMPLES\n.nf\n";
        const std::size_t at = page.find(begin);
        ASSERT_NE(at, std::string::npos) << command;
        std::string example = page.substr(at + begin.size(), page.find('\n', at + begin.size()) - at - begin.size());
        std::erase(example, '\\');
        EXPECT_TRUE(example.starts_with("render2mpeg " + command + " ")) << example;
        EXPECT_EQ(page.find("Example: "), std::string::npos) << command;
        const std::string all = support::contents(support::binary_folder() / "shell/render2mpeg.1");
        EXPECT_NE(all.find("render2mpeg " + page.substr(at + begin.size() + 12, command.size())), std::string::npos);
    }
}

TEST(Completion, OfZshAndFishOffersEveryOption) {
    const std::string zsh = support::contents(support::binary_folder() / "shell/_render2mpeg");
    const std::string fish = support::contents(support::binary_folder() / "shell/render2mpeg.fish");
    for (const std::string command : {"render", "encode", "plan", "info", "cost", "tune", "compare", "farm", "part",
                                      "join", "farm-status", "watch"}) {
        const std::size_t begin = zsh.find("\n    " + command + ")\n");
        ASSERT_NE(begin, std::string::npos) << command;
        const std::string part = zsh.substr(begin, zsh.find(";;", begin) - begin);
        std::istringstream help(run(program() + " " + command + " --help").output);
        for (std::string line; std::getline(help, line);) {
            const std::size_t at = line.find("--");
            if (!line.starts_with("  -") || at == std::string::npos) continue;
            const std::string option = line.substr(at, line.find_first_of(" ,", at) - at);
            EXPECT_NE(part.find("'" + option + "["), std::string::npos) << "zsh: " << command << line;
            EXPECT_NE(fish.find("__fish_seen_subcommand_from " + command + "' -l " + option.substr(2) + " "),
                      std::string::npos)
                << "fish: " << command << line;
        }
    }
}

TEST(Completion, IsReadByItsShell) {
    const std::string folder = (support::binary_folder() / "shell").string();
    for (const std::string& reads : {"bash -n " + folder + "/render2mpeg.bash", "zsh -n " + folder + "/_render2mpeg",
                                     "fish --no-execute " + folder + "/render2mpeg.fish"}) {
        if (run("command -v " + reads.substr(0, reads.find(' '))).status != 0) continue;
        const auto outcome = run(reads);
        EXPECT_EQ(outcome.status, 0) << reads << ": " << outcome.output;
    }
}

TEST(Completion, OffersFilesElsewhere) {
    const Folder folder;
    EXPECT_EQ(run("touch " + (folder / "scene.glb").string()).status, 0);
    const std::string name = (folder / "scene.glb").string();
    for (const char* before : {"render ", "render --stats ", "info "})
        EXPECT_EQ(completions(before + (folder / "sc").string()), std::set<std::string>{name}) << before;
}

}  // namespace
}  // namespace render2mpeg
