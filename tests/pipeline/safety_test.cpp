#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "app/files/work_folder.h"
#include "app/production/resume.h"
#include "core/error.h"
#include "pipeline/fixture.h"

/// Nothing of a user's is replaced or removed unseen, and no output that fails costs another.
namespace render2mpeg::test {
namespace {

const std::string plain = " --samples 1 --exposure 0 --tolerance fixed=10% ";
const std::string smallest = plain + "--size 32x32 --frames 0:1 ";

std::string render_to(const Folder& folder, const std::string& output, const std::string& options) {
    const auto unless = [&](const std::string& name, const char* value) {
        return options.find(name) == std::string::npos ? name + value : std::string();
    };
    return program() + " render " + plain_film() + plain + unless("--size", " 32x32 ") + unless("--frames", " 0:1 ") +
           options + " -o " + path(folder, output);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

bool tells(const support::Outcome& outcome, const std::string& words) {
    return outcome.output.find(words) != std::string::npos;
}

TEST(Inputs, AreNoOutputsByWhateverName) {
    const Folder folder;
    std::filesystem::copy(plain_film(), folder / "scene", std::filesystem::copy_options::recursive);
    const std::string scene = contents(folder / "scene" / "film.json");
    ASSERT_FALSE(scene.empty());
    write_text(folder / "keys.txt", "0\n");
    const std::string start =
        "cd " + path(folder, "scene") + " && " + program() + " render . -o film.mpg --quiet" + smallest;

    // The report of a film in the scene's own folder lies beside the scene's file.
    auto outcome = run(start + "--report film.html");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(contents(folder / "scene" / "film.json"), scene);
    EXPECT_TRUE(json::parse(contents(folder / "scene" / "film.report.json")).contains("plan"));

    for (const char* options :
         {"--stats film.json", "--stats ../scene/film.json", "--keyframes ../keys.txt --stats ../keys.txt"}) {
        outcome = run(start + options);
        EXPECT_EQ(outcome.status, 1) << options;
        EXPECT_TRUE(tells(outcome, "it is an input")) << outcome.output;
    }
    EXPECT_EQ(contents(folder / "scene" / "film.json"), scene);
    EXPECT_EQ(contents(folder / "keys.txt"), "0\n");
}

TEST(Inputs, OfEncodingAreNoOutputsFrameByFrame) {
    const Folder folder;
    ASSERT_EQ(run(render_to(folder, "f.%03d.exr", "--quiet --aov " + path(folder, "v"))).status, 0);
    const std::string start = program() + " encode " + path(folder, "f.%03d.exr") + " -o " + path(folder, "e.mpg") +
                              " --motion " + path(folder, "v/frame_%04d.exr") + " --quiet --stats ";
    for (const char* taken : {"f.001.exr", "v/frame_0001.exr"}) {
        const std::string before = contents(folder / taken);
        const auto outcome = run(start + path(folder, taken));
        EXPECT_EQ(outcome.status, 1) << taken;
        EXPECT_TRUE(tells(outcome, "it is an input")) << outcome.output;
        EXPECT_EQ(contents(folder / taken), before);
    }
    EXPECT_EQ(run(start + path(folder, "f.002.exr")).status, 0) << "no frame of this film";
}

TEST(Outputs, OfOneNameAreRefusedFrameByFrame) {
    const Folder folder;
    std::filesystem::create_directory(folder / "v");
    const std::string layers = "--dry-run --within 0 --aov " + path(folder, "v");
    EXPECT_TRUE(tells(run(render_to(folder, "v/frame_%04d.exr", layers)), "two outputs have this name"));
    EXPECT_EQ(run(render_to(folder, "v/f_%04d.exr", layers)).status, 0);
    EXPECT_EQ(run(render_to(folder, "v/frame_%05d.exr", layers)).status, 0) << "00001 is not 0001";
    EXPECT_EQ(run(render_to(folder, "v/frame_0%d.exr", layers + " --hold --frames 0:99")).status, 0);
    EXPECT_EQ(run(render_to(folder, "v/frame_0%d.exr", layers + " --hold --frames 0:100")).status, 1) << "0100 is";
    EXPECT_EQ(run(render_to(folder, "x.%d.png", layers + " --stats " + path(folder, "v/frame_0001.exr"))).status, 1);
    EXPECT_EQ(run(render_to(folder, "x.%d.png", layers + " --stats " + path(folder, "x.1.png"))).status, 1);
}

TEST(Report, ReplacesNothingButAnEarlierReportSlow) {
    const Folder folder;
    const std::string render = render_to(folder, "f.mpg", "--quiet --report " + path(folder, "r.html"));
    for (const char* name : {"r.html", "r.report.json"}) {
        write_text(folder / name, R"(<!DOCTYPE html><title>my page</title>)");
        for (const char* more : {" --dry-run --within 0", ""}) {
            const auto outcome = run(render + more);
            EXPECT_EQ(outcome.status, 1) << name;
            EXPECT_TRUE(tells(outcome, std::string(name) + ": what has this name is no earlier report"))
                << outcome.output;
        }
        EXPECT_EQ(contents(folder / name), R"(<!DOCTYPE html><title>my page</title>)");
        EXPECT_EQ(folder.entries(), 1u);
        std::filesystem::remove(folder / name);
    }
    EXPECT_EQ(run(render).status, 0);
    const std::string first = contents(folder / "r.report.json");
    EXPECT_EQ(run(render).status, 1) << "the film is there";
    EXPECT_EQ(run(render + " -y").status, 0) << "its own it replaces";
    EXPECT_NE(contents(folder / "r.report.json"), first);
    EXPECT_EQ(folder.entries(), 3u);
}

TEST(Outputs, ThatFailCostNoOthersSlow) {
    const Folder folder;
    const auto outcome = run(render_to(folder, "f.mpg", "--stats /dev/full --report " + path(folder, "r.html")));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(tells(outcome, "render2mpeg: writing /dev/full: No space left")) << outcome.output;
    EXPECT_TRUE(tells(outcome, "f.mpg: ")) << "the summary: " << outcome.output;
    for (const char* there : {"f.mpg", "r.html", "r.report.json"}) EXPECT_TRUE(std::filesystem::exists(folder / there));
    EXPECT_EQ(folder.entries(), 4u);  // with f.mpg.partial: --resume may tell what was not told

    test::write_frames(path(folder, "in.y4m"), 64, 48, "25:1", "1:1", 2);
    const auto encoded =
        run(program() + " encode " + path(folder, "in.y4m") + " --stats /dev/full -o " + path(folder, "e.mpg"));
    EXPECT_EQ(encoded.status, 1);
    EXPECT_TRUE(tells(encoded, "e.mpg: ")) << encoded.output;
}

TEST(Outputs, AreWrittenWholeOrNotAtAll) {
    const Folder folder, other;
    const auto film = [](const Folder& to) {
        return render_to(to, "f.m2v",
                         "--quiet -y --size 16x16 --frames 0:4 --quantiser 31 --stats " + path(to, "s.json"));
    };
    ASSERT_EQ(run(film(other)).status, 0);
    write_text(folder / "s.json", "{\"before\": 1}");
    // All fits but the statistics, in blocks of 512 bytes. Their length depends on the digits of times: a tenth is left
    // for them.
    const auto blocks = std::filesystem::file_size(other / "s.json") * 9 / 10 / 512;
    const auto outcome = run("trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; " + film(folder));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(tells(outcome, "s.json: File too large")) << outcome.output;
    EXPECT_TRUE(std::filesystem::exists(folder / "f.m2v"));
    EXPECT_EQ(contents(folder / "s.json"), "{\"before\": 1}");
    EXPECT_TRUE(std::filesystem::exists(folder / "f.m2v.partial")) << "--resume may tell what was not told";
    EXPECT_EQ(folder.entries(), 3u);
}

TEST(Outputs, AreSeenToBeProtectedBeforeAnythingIsDone) {
    const Folder folder;
    write_text(folder / "s.json", "{}");
    chmod((folder / "s.json").c_str(), 0444);
    // For root nothing is protected, unless it gives up that right; another user might not reach the program.
    const std::string as_user = geteuid() == 0 ? "setpriv --bounding-set=-dac_override,-dac_read_search " : "";
    if (run(as_user + "true").status != 0) GTEST_SKIP() << "root cannot give up its rights here";
    for (const char* more : {"--dry-run --within 0 ", ""}) {
        const auto outcome = run(as_user + render_to(folder, "f.mpg", more + ("--stats " + path(folder, "s.json"))));
        EXPECT_EQ(outcome.status, 1);
        EXPECT_TRUE(tells(outcome, "s.json: Permission denied")) << outcome.output;
        EXPECT_EQ(folder.entries(), 1u);
    }
}

TEST(Heatmap, ThatFailsCostsNoFilmSlow) {
    const Folder folder;
    // Blocks of 512 bytes: the film and its statistics fit, heatmaps do not.
    const auto outcome =
        run("trap '' XFSZ; ulimit -f 100; " +
            render_to(folder, "f.mpg",
                      "--quantiser 31 --frames 0:24 --size 96x64 --heatmap cut " + path(folder, "h.m2v") +
                          " --heatmap quantiser " + path(folder, "q.m2v") + " --stats " + path(folder, "s.json")));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(tells(outcome, "File too large")) << outcome.output;
    EXPECT_TRUE(tells(outcome, "f.mpg: ")) << "the summary: " << outcome.output;
    EXPECT_TRUE(std::filesystem::exists(folder / "f.mpg"));
    EXPECT_EQ(json::parse(contents(folder / "s.json")).at("frames"), 25);
    EXPECT_FALSE(std::filesystem::exists(folder / "h.m2v"));
    EXPECT_FALSE(std::filesystem::exists(folder / "h.m2v.partial"));
}

TEST(Heatmap, LeavesFilesOfEveryNameAlone) {
    const Folder folder;
    write_text(folder / "h.mpg.unfinished", "mine");
    EXPECT_EQ(run(render_to(folder, "f.mpg", "--quiet --heatmap cut " + path(folder, "h.mpg"))).status, 0);
    EXPECT_EQ(contents(folder / "h.mpg.unfinished"), "mine");
    EXPECT_EQ(folder.entries(), 3u);
}

TEST(Names, ThatAreNoUtf8AreNamesAllTheSame) {
    const Folder folder;
    const std::string name = "caf\xe9";
    const auto outcome =
        run(render_to(folder, name + ".mpg",
                      "--quiet --stats " + path(folder, name + ".json") + " --report " + path(folder, name + ".html")));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(std::filesystem::exists(folder / (name + ".mpg")));
    EXPECT_TRUE(json::parse(contents(folder / (name + ".json"))).contains("command"));
    EXPECT_EQ(folder.entries(), 4u) << "no work folder is left";
}

/// Begins a film and interrupts it once it has bytes.
support::Outcome interrupt(const std::string& render, const std::string& file) {
    return run(render + " & job=$!; while [ ! -s " + file +
               " ]; do kill -0 $job || exit 99; sleep 0.05; done; kill -INT $job; wait $job");
}

TEST(Interrupts, LeaveAPlayableFilmInTheWorkFolder) {
    const Folder folder;
    const std::string endless =
        support::program_at_terminal() + " render " + plain_film() +
        " --size 32x32 --samples 1 --vpls 0 --tolerance fixed=90% --hold --frames 0:9999 --exposure 0 --quiet -o " +
        path(folder, "a.mpg");
    write_text(folder / "a.partial.mpg", "a diary");
    EXPECT_EQ(interrupt(endless, path(folder, "a.mpg.partial/chunk_00000.m2v")).status, 130);
    EXPECT_EQ(run(program() + " info " + path(folder, "a.mpg.partial/film.mpg")).status, 0);
    ASSERT_EQ(run(render_to(folder, "a.mpg", "--quiet")).status, 0);
    EXPECT_EQ(contents(folder / "a.partial.mpg"), "a diary");
    EXPECT_EQ(folder.entries(), 2u) << "the next film of the name removes it";
}

app::Film film_of(const std::string& source) {
    app::Film made;
    made.source = source;
    made.frames = {0, 9};
    return made;
}

TEST(WorkFolder, IsItsRunsAloneWhileOthersEndAndBeginSlow) {
    const Folder folder;
    std::atomic<int> had{0}, lost{0};
    const auto runs = [&] {
        // Whoever is refused tries again: one of them always has it.
        for (int i = 0; had < 150 && i < 1'000'000; ++i) {
            try {
                app::WorkFolder work(folder / "a.mpg", app::identity_of(film_of("s"), "render"));
                const std::filesystem::path file = work.begin("film.mpg");
                write_text(file, "pictures");
                ++had;
                std::this_thread::yield();
                if (contents(file) != "pictures" || !std::filesystem::exists(work.place("manifest.json"))) ++lost;
                work.remove();
            } catch (const core::Error&) {
                // Another has it.
            }
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i) threads.emplace_back(runs);
    for (std::thread& thread : threads) thread.join();
    EXPECT_GE(had, 150);
    EXPECT_EQ(lost, 0);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Lock, WaitsForALookAndGivesUpAtWhatLeadsNowhere) {
    const Folder folder;
    const app::OutputLock holder(folder / "lock", "film");
    EXPECT_THROW(app::OutputLock(folder / "lock", "film"), core::Error);
    std::filesystem::create_symlink(folder / "nowhere" / "lock", folder / "dangling");
    EXPECT_THROW(app::OutputLock(folder / "dangling", "film"), core::Error);

    // Dry runs look all the time, each for an instant.
    std::atomic<bool> enough{false};
    std::thread looker([&] {
        while (!enough) {
            try {
                app::OutputLock::check(folder / "free", "film");
            } catch (const core::Error&) {
                // It is held just now.
            }
        }
    });
    for (int i = 0; i < 50; ++i) EXPECT_NO_THROW(app::OutputLock(folder / "free", "film"));
    enough = true;
    looker.join();
}

TEST(Exposure, OfFramesWithAToleranceIsNotSaidToDoNothing) {
    const Folder folder;
    const auto said = [&](const char* tolerance) {
        return run(program() + " render " + plain_film() +
                   " --size 32x32 --exposure 1 --dry-run --within 0 --tolerance " + tolerance + " -o " +
                   path(folder, "f.%d.exr"))
            .output;
    };
    for (const char* tolerance : {"reference", "fixed=0%"})
        EXPECT_NE(said(tolerance).find("--exposure does nothing here"), std::string::npos) << tolerance;
    EXPECT_EQ(said("fixed=2%").find("--exposure"), std::string::npos) << "it sets the least tolerance";
}

TEST(CommandLine, OfStatisticsCanBeGivenToAShellAgain) {
    const Folder folder;
    const std::string odd = path(folder, "it's a $film (1).mpg"),
                      quoted = "\"" + path(folder, "it's a \\$film (1).mpg") + "\"";
    const std::string statistics = path(folder, "s.json");
    ASSERT_EQ(run(program() + " render " + plain_film() + smallest + "--quiet -o " + quoted + " --stats " + statistics)
                  .status,
              0);
    const std::string again = json::parse(contents(statistics)).at("command").get<std::string>();
    std::filesystem::remove(odd);
    std::filesystem::remove(statistics);
    EXPECT_EQ(run(again).status, 0) << again;
    EXPECT_TRUE(std::filesystem::exists(odd)) << again;
}

TEST(StandardOutput, ThatIsFullIsAnError) {
    const Folder folder;
    ASSERT_EQ(run(render_to(folder, "f.mpg", "--quiet")).status, 0);
    for (const std::string& command : {" info " + path(folder, "f.mpg"), " plan --within 0 " + plain_film()}) {
        const auto outcome = run(program() + command + " > /dev/full");
        EXPECT_EQ(outcome.status, 1) << command;
        EXPECT_EQ(outcome.output, "render2mpeg: writing standard output: No space left on device\n");
    }
}

}  // namespace
}  // namespace render2mpeg::test
