#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Where a film is made, and what else lies there.
namespace render2mpeg::test {
namespace {

const std::string tiny = " --size 32x32 --samples 1 --exposure 0 --frames 0:1 ";
/// Never done before it is interrupted.
const std::string endless =
    " --size 32x32 --samples 1 --vpls 0 --tolerance fixed=90% --hold --frames 0:9999 --exposure 0 --quiet ";

/// Runs a render until `file` is there and not empty, then does `then`, then sends the signal and waits.
support::Outcome interrupted(const std::string& render, const std::string& file, const std::string& signal,
                             const std::string& then = ":") {
    return run("env --default-signal=INT " + render + " & job=$!; while [ ! -s " + file +
               " ]; do kill -0 $job || exit 99; sleep 0.05; done; " + then + "; sleep 0.3; kill -" + signal +
               " $job; wait $job");
}

TEST(Outputs, AreLookedAtBeforeTheSceneIsRead) {
    const Folder folder;
    std::ofstream(folder / "there.mpg") << "a film";
    const auto said = [&](const std::string& options) {
        return run(program() + " render " + path(folder, "no.blend") + " -o " + path(folder, options)).output;
    };
    EXPECT_NE(said("there.mpg").find("is there already; -y replaces it"), std::string::npos);
    EXPECT_NE(said("none/f.mpg").find("there is no folder"), std::string::npos);
    EXPECT_NE(said("new.mpg").find("there is no such file"), std::string::npos);
}

TEST(Outputs, ShowTheFrameLitLast) {
    const Folder folder;
    const auto outcome = run(program() + " render " + plain_film() + tiny + "--quiet -o " + path(folder, "f.mpg") +
                             " --last-frame " + path(folder, "now.png"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(support::contents(folder / "now.png").starts_with("\x89PNG"));
    EXPECT_EQ(folder.entries(), 2u) << "nothing unfinished";
}

TEST(WorkFolder, IsAnotherForFilmsOfOneStemSlow) {
    const Folder folder;
    const std::string start = program() + " render " + plain_film() + endless + "-o ";
    const std::string second = program() + " render " + plain_film() + tiny + "--quiet -o " + path(folder, "a.mkv");
    const auto outcome = interrupted(start + path(folder, "a.mpg"), path(folder, "a.mpg.partial/chunk_00000.m2v"),
                                     "INT", second + " || echo the second failed");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_EQ(outcome.output, "");
    EXPECT_TRUE(std::filesystem::exists(folder / "a.mkv"));
    EXPECT_TRUE(std::filesystem::exists(folder / "a.mpg.partial/film.mpg")) << "the first went on beside it";
}

TEST(WorkFolder, IsNoOtherRunsMeanwhileSlow) {
    const Folder folder;
    const std::string out = "-o " + path(folder, "a.mpg");
    const std::string again = program() + " render " + plain_film() + tiny + "--quiet " + out;
    const auto outcome = interrupted(program() + " render " + plain_film() + endless + out,
                                     path(folder, "a.mpg.partial/chunk_00000.m2v"), "TERM",
                                     again + "; echo status $?; " + again + " --dry-run --within 0; echo status $?");
    EXPECT_EQ(outcome.status, 143) << "128 + SIGTERM: " << outcome.output;
    const std::size_t first = outcome.output.find("a.mpg: another run is writing it (process ");
    ASSERT_NE(first, std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("status 1", first), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("another run", first + 20), std::string::npos) << "the dry run, too";
    // The one who was there first was not disturbed, and who comes later is free to begin anew.
    EXPECT_TRUE(std::filesystem::exists(folder / "a.mpg.partial/film.mpg"));
    EXPECT_EQ(run(again).status, 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.mpg.partial"));
}

TEST(Pipes, ThatNobodyReadsEndWithTheFirstSignalSlow) {
    const Folder folder;
    test::write_frames(path(folder, "in.y4m"), 32, 32, "25:1", "1:1", 2);
    ASSERT_EQ(run("mkfifo " + path(folder, "p.mpg")).status, 0);
    const std::string film = program() + " render " + plain_film() + tiny + " --quiet -y -o ";
    // All wait at once, each in a folder of its own.
    const std::string commands[] = {film + "p.mpg", film + "f.mpg --stats p.json",
                                    film + "f.mpg --heatmap quantiser p.mpg",
                                    program() + " encode ../in.y4m --quiet -y -o p.mpg"};
    std::string all = "cd " + folder.path().string() + "; ";
    for (std::size_t k = 0; k < 8; ++k)
        all += fmt::format(
            "(mkdir {0}; cd {0}; mkfifo p.mpg p.json; env --default-signal=INT timeout --signal=KILL 60 {1} & job=$!; "
            "sleep 4; kill -{2} $job; wait $job; echo $? > status) & ",
            k, commands[k / 2], k % 2 == 0 ? "INT" : "TERM");
    const auto outcome = run(all + "wait");
    for (std::size_t k = 0; k < 8; ++k)
        EXPECT_EQ(contents(folder / std::to_string(k) / "status"), k % 2 == 0 ? "130\n" : "143\n")
            << commands[k / 2] << outcome.output;
    // Who comes late gets the film, and who goes early is told.
    const auto late = run(film + path(folder, "p.mpg") + " & job=$!; sleep 1; cat " + path(folder, "p.mpg") + " > " +
                          path(folder, "read.mpg") + "; wait $job");
    EXPECT_EQ(late.status, 0) << late.output;
    ASSERT_EQ(run(film + path(folder, "f.mpg")).status, 0);
    EXPECT_EQ(contents(folder / "read.mpg"), contents(folder / "f.mpg"));
    EXPECT_EQ(run("setsid -w timeout 60 " + film + path(folder, "f.mpg") + " --stats /dev/tty").status, 1)
        << "there is no terminal to wait for";
    std::filesystem::create_symlink("/dev/full", folder / "full.mpg");
    EXPECT_NE(run(film + path(folder, "full.mpg")).output.find("full.mpg: No space left"), std::string::npos);
}

TEST(WorkFolder, OfImagesIsGoneWhereNoneCouldBeWritten) {
    const Folder folder;
    const auto full =
        run("ulimit -f 4; " + program() + " render " + plain_film() +
            " --size 320x240 --samples 1 --vpls 0 --exposure 0 --frames 0:1 --quiet -o " + path(folder, "p%03d.png"));
    EXPECT_EQ(full.status, 1) << full.output;
    EXPECT_EQ(std::count(full.output.begin(), full.output.end(), '\n'), 1) << full.output;
    EXPECT_EQ(folder.entries(), 0u) << full.output;
}

TEST(WorkFolder, ThatIsForeignIsRefusedBeforeAnythingIsDone) {
    const Folder folder;
    std::filesystem::create_directory(folder / "a.mpg.partial");
    std::ofstream(folder / "a.mpg.partial" / "diary.txt") << "dear diary";
    const std::string start = program() + " render " + plain_film() + tiny + " -o " + path(folder, "a.mpg");
    for (const char* more : {" --dry-run --within 0", " --bitrate 1M"}) {
        const auto outcome = run(start + more);
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        EXPECT_NE(outcome.output.find("a.mpg.partial"), std::string::npos) << outcome.output;
        EXPECT_EQ(outcome.output.find("first pass"), std::string::npos) << outcome.output;
    }
    EXPECT_EQ(contents(folder / "a.mpg.partial" / "diary.txt"), "dear diary");
}

TEST(WorkFolder, LeavesNoTraceOfWhatFailsBeforeTheFirstFrame) {
    const Folder folder;
    test::write_frames(path(folder, "in.y4m"), 64, 48, "25:1", "1:1", 4);
    const auto outcome =
        run(program() + " encode " + path(folder, "in.y4m") + " --bitrate 500 -o " + path(folder, "o.mpg"));
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_EQ(folder.entries(), 1u) << outcome.output;
}

TEST(WritableCheck, LeavesFilesOfEveryNameAlone) {
    const Folder folder;
    std::ofstream(folder / "x.mpg.probe") << "mine";
    ASSERT_EQ(run(program() + " render " + plain_film() + tiny + "--quiet -o " + path(folder, "x.mpg")).status, 0);
    EXPECT_EQ(contents(folder / "x.mpg.probe"), "mine");
    EXPECT_EQ(folder.entries(), 2u);
}

TEST(Interruption, LeavesTheFirstFramesOfUncompressedFilms) {
    const Folder folder;
    const auto outcome =
        interrupted(program() + " render " + plain_film() +
                        " --size 64x48 --vpls 0 --hold --frames 0:9999 --exposure 0 --tolerance fixed=10% -o " +
                        path(folder, "f.y4m"),
                    path(folder, "f.y4m.partial/chunk_00000.y4m.tmp"), "INT");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_NE(outcome.output.find("f.y4m.partial/film.y4m: "), std::string::npos) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "f.y4m"));
    const auto decoded = run("ffmpeg -v error -xerror -i " + path(folder, "f.y4m.partial/film.y4m") + " -f null -");
    EXPECT_EQ(decoded.status, 0) << decoded.output;
    EXPECT_EQ(decoded.output, "");
}

}  // namespace
}  // namespace render2mpeg::test
