#include <gtest/gtest.h>
#include <sys/xattr.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// What becomes of a film between its last frame and its last file, and of a film that is whole already.
namespace render2mpeg::test {
namespace {

const std::string quick = " --size 32x32 --samples 1 --vpls 0 --tolerance fixed=90% --exposure 0 --threads 1 --gop 15 ";

std::string render_whole(const Folder& folder, const std::string& output, const std::string& more = "--frames 0:1") {
    return program() + " render -y --hold " + plain_film() + quick + more + " -o " + path(folder, output);
}

bool has_attributes(const Folder& folder) {
    std::ofstream(folder / "probe") << "x";
    const bool kept = setxattr((folder / "probe").c_str(), "user.render2mpeg.probe", "x", 1, 0) == 0;
    std::filesystem::remove(folder / "probe");
    return kept;
}

TEST(WholeFilm, IsNotRenderedAnewByResumeSlow) {
    const Folder folder;
    if (!has_attributes(folder)) GTEST_SKIP() << "this file system keeps no attributes";
    for (const std::string output : {"f.mpg", "f.y4m", "f.%03d.exr"}) {
        const std::string start = render_whole(folder, output, "--frames 0:1 --stats " + path(folder, "s.json"));
        const auto first = folder / (output == "f.%03d.exr" ? "f.000.exr" : output);
        ASSERT_EQ(run(start + " --quiet").status, 0);
        const auto written = std::filesystem::last_write_time(first);
        const auto resumed = [&](const std::string& more) { return run(start + " --resume " + more); };
        const std::string whole = path(folder, output) + " is whole already: nothing is left to be done\n";
        const auto says = [](const support::Outcome& outcome, const std::string& words) {
            return outcome.output.find(words) != std::string::npos;
        };
        for (const char* more : {"", "--dry-run --within 0", "--memory 8G"}) {
            const auto outcome = resumed(more);
            EXPECT_EQ(outcome.status, 0) << outcome.output;
            EXPECT_TRUE(says(outcome, whole)) << outcome.output;
        }
        EXPECT_EQ(std::filesystem::last_write_time(first), written) << "nothing was done";

        // Another film begins anew; so does one that somebody has changed, and what can only be made with the film.
        for (const std::string& more :
             {std::string("--clamp none"), "--clamp none --report " + path(folder, "r.html")}) {
            const auto other = resumed(more);
            EXPECT_EQ(other.status, 0) << other.output;
            EXPECT_TRUE(says(other, "begins anew")) << other.output;
            EXPECT_TRUE(says(resumed(more), whole)) << more;
        }
        std::ofstream(first, std::ios::app) << "x";
        EXPECT_TRUE(says(resumed("--clamp none"), "begins anew"));
    }
}

TEST(WholeFilm, LeavesAloneWhatIsAnothersBesideIt) {
    const Folder folder;
    if (!has_attributes(folder)) GTEST_SKIP() << "this file system keeps no attributes";
    const std::string start = render_whole(folder, "f.mpg");
    ASSERT_EQ(run(start + " --quiet").status, 0);
    const std::filesystem::path beside = folder / "f.mpg.partial";
    std::filesystem::create_directory(beside);
    std::ofstream(beside / "manifest.json") << R"({"identity": {"version": "another"}})";
    std::ofstream(beside / "chunk_00000.m2v") << "pictures";
    const auto outcome = run(start + " --resume");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("is whole already"), std::string::npos) << outcome.output;
    EXPECT_EQ(contents(beside / "chunk_00000.m2v"), "pictures");
}

TEST(WholeFilm, IsMadeOfWhatStaysUntilStatisticsAreWrittenSlow) {
    for (const auto& [option, name] : {std::pair("--stats ", "told.json"), std::pair("--report ", "told.html")}) {
        const Folder folder;
        const std::string start = render_whole(folder, "f.mpg", "--frames 0:1 " + (option + path(folder, name)));
        std::filesystem::create_symlink("/dev/full", folder / name);
        const auto full = run(start);
        EXPECT_EQ(full.status, 1) << full.output;
        EXPECT_NE(full.output.find("with --resume only what comes after the last frame is done again"),
                  std::string::npos)
            << full.output;
        const std::string film = contents(folder / "f.mpg");
        EXPECT_FALSE(film.empty()) << "the film itself has its name";
        std::filesystem::remove(folder / name);
        const auto resumed = run(start + " --resume");
        EXPECT_EQ(resumed.status, 0) << resumed.output;
        EXPECT_NE(resumed.output.find("2 of 2 are there"), std::string::npos) << resumed.output;
        EXPECT_TRUE(contents(folder / "f.mpg") == film);
        EXPECT_FALSE(contents(folder / name).empty());
        EXPECT_FALSE(std::filesystem::exists(folder / "f.mpg.partial"));
    }
}

/// Calls `meets(frames)`, which starts a film and meets it at work, with longer and longer films until it returns
/// anything but too_late: a busy machine may look away for longer than a short one takes. Returns what it did.
constexpr int too_late = 99;
template <class Meets>
support::Outcome met_at_work(int frames, Meets&& meets) {
    support::Outcome outcome = meets(frames);
    for (int tries = 0; outcome.status == too_late && tries < 4; ++tries) outcome = meets(frames *= 2);
    return outcome;
}

/// Shell that waits until the job has made a file, and gives up where it ends before.
std::string waits_for(const std::string& file) {
    return " & job=$!; while [ ! -s " + file + " ]; do kill -0 $job 2>/dev/null || exit 99; sleep 0.01; done; ";
}

TEST(Heatmap, ThatCannotHaveItsNameAtLastMayHaveItLaterSlow) {
    const Folder folder;
    const std::string heat = path(folder, "heat.mpg");
    std::string start, whole, all;
    // Somebody takes its name while it is made.
    const auto outcome = met_at_work(60, [&](int frames) {
        all = std::to_string(frames);
        start = render_whole(folder, "f.mpg", "--frames 0:" + std::to_string(frames - 1) + " --heatmap cut " + heat);
        EXPECT_EQ(run(start + " --quiet").status, 0);
        whole = contents(heat);
        std::filesystem::remove(heat);
        return run(start + waits_for(path(folder, "f.mpg.partial/chunk_00000.cut-*.m2v")) + "mkdir " + heat +
                   "; touch " + heat + "/mine; wait $job");
    });
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_NE(outcome.output.find("with --resume only what comes after the last frame is done again"),
              std::string::npos)
        << outcome.output;
    std::filesystem::remove_all(heat);
    const auto resumed = run(start + " --resume");
    EXPECT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_NE(resumed.output.find(all + " of " + all + " are there"), std::string::npos) << resumed.output;
    EXPECT_TRUE(contents(heat) == whole) << "no frame of it was lost";
    EXPECT_EQ(folder.entries(), 2u) << "no work folder is left";
}

TEST(Heatmap, ThatIsGivenUpLeavesNothingSlow) {
    const Folder folder;
    const std::string heat = path(folder, "heat.mpg"), film = path(folder, "f.mpg");
    for (const char* way : {" --resume", ""}) {
        std::string start;
        const auto killed = met_at_work(120, [&](int frames) {
            for (const std::string& made : {heat, film}) std::filesystem::remove(made);
            start = render_whole(folder, "f.mpg", "--frames 0:" + std::to_string(frames - 1));
            return run(start + " --heatmap cut " + heat + waits_for(film + ".partial/chunk_00000.json") +
                       "kill -KILL $job; wait $job; test -e " + heat + ".partial || exit 99; exit 137");
        });
        ASSERT_EQ(killed.status, 137) << killed.output;
        const auto outcome = run(start + way);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        EXPECT_EQ(folder.entries(), 1u) << way;
    }
}

}  // namespace
}  // namespace render2mpeg::test
