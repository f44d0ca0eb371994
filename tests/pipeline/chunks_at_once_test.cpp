#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/files/chunk_file.h"
#include "pipeline/fixture.h"

/// Chunks that are made beside each other leave no trace in what is written.
namespace render2mpeg::test {
namespace {

class ChunksAtOnce : public testing::Test {
  protected:
    /// Four chunks of 41 frames, the last of 4.
    ChunksAtOnce() { std::ofstream(folder_ / "scene.json") << support::travel_scene(127); }

    std::string start(const std::string& more) const {
        return program() + " render -y " + path(folder_, "scene.json") + " --size 16x16 --samples 1 --gop 41 " + more +
               " ";
    }
    std::string file(const std::string& name) const { return path(folder_, name); }
    std::string bytes(const std::string& name) const { return contents(folder_ / name); }
    /// Expects the command to end with 0.
    void make(const std::string& command) const {
        const auto outcome = run(command);
        EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.output;
    }
    /// Renders all but the film's name, which is taken, so that its work folder stays.
    void make_unnamed(const std::string& command) const {
        const auto outcome = run(command + " & job=$!; while [ ! -e " + file("film.mpg.partial/chunk_00000.m2v") +
                                 " ]; do kill -0 $job || exit 99; sleep 0.01; done; mkdir " + file("film.mpg") +
                                 "; touch " + file("film.mpg/mine") + "; wait $job");
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        std::filesystem::remove_all(folder_ / "film.mpg");
    }

    const Folder folder_;
    /// Lit in no time.
    const std::string direct_ = "--vpls 0 --tolerance fixed=10% --exposure 0 ";
};

/// Statistics without times, memory and names.
json lasting(const std::string& text) {
    json s = json::parse(text);
    for (const char* key : {"seconds", "passes", "peak_rss_mib", "command", "output"}) s.erase(key);
    for (const char* key : {"calibration_seconds", "sky_seconds", "layer_seconds"}) s["counts"].erase(key);
    if (s["audit"].is_object()) s["audit"].erase("seconds");
    for (json& frame : s["per_frame"])
        for (const char* time : {"seconds", "seconds_by_stage"}) frame.erase(time);
    for (json& effect : s["effects"]) effect.erase("seconds");
    return s;
}

TEST_F(ChunksAtOnce, ChangeNoByteOfAFilmForAnyNumberOfThreadsSlow) {
    make(start(direct_ + "--quiet --threads 1 --chunks-at-once 1 -o " + file("one.mpg")));
    const std::string film = bytes("one.mpg");
    for (const auto& [chunks, threads] : {std::pair{1, 33}, {2, 1}, {2, 3}, {3, 2}, {3, 16}, {9, 2}}) {
        make(start(direct_ + "--quiet --threads " + std::to_string(threads) + " --chunks-at-once " +
                   std::to_string(chunks) + " -o " + file("film.mpg")));
        EXPECT_TRUE(bytes("film.mpg") == film) << chunks << " at once by " << threads << " threads";
    }
}

TEST_F(ChunksAtOnce, ChangeNeitherFilmNorStatisticsOfLightThatIsKeptSlow) {
    const std::string begin = start("--quiet --threads 3 --audit 1 ");
    for (const char* chunks : {"1", "3"})
        make(begin + "--chunks-at-once " + chunks + " -o " + file(std::string(chunks) + ".mpg") + " --stats " +
             file(std::string(chunks) + ".json"));
    EXPECT_TRUE(bytes("3.mpg") == bytes("1.mpg"));
    EXPECT_EQ(lasting(bytes("3.json")), lasting(bytes("1.json")));
}

TEST_F(ChunksAtOnce, ChangeNoFrameThatIsNotCodedSlow) {
    for (const char* chunks : {"1", "3"}) {
        const std::string name = chunks;
        std::filesystem::create_directory(folder_ / name);
        const std::vector<std::string> outputs{"/f.%03d.exr", "/f.%03d.png --last-frame " + file(name + "/last.png"),
                                               "/f.y4m --aov " + file(name)};
        for (const std::string& output : outputs)
            make(start(direct_ + "--quiet --threads 3 --chunks-at-once " + name + " -o " + file(name + output)));
        std::filesystem::remove(folder_ / name / "last.png");
    }
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "1")) {
        const std::string name = entry.path().filename().string();
        EXPECT_TRUE(contents(entry.path()) == bytes("3/" + name)) << name;
        ++files;
    }
    EXPECT_EQ(files, 4 * 127 + 1u) << "two kinds of images, layers and motion";
}

TEST_F(ChunksAtOnce, ResumingKeepsThoseBehindAGapSlow) {
    const std::string begin =
        start("--threads 2 --stats " + file("film.json") + " --chunks-at-once 2 -o " + file("film.mpg"));
    make_unnamed(begin);
    for (const char* lost : {"film.mpg.partial/chunk_00000.json", "film.mpg.partial/chunk_00002.json"})
        ASSERT_TRUE(std::filesystem::remove(folder_ / lost));
    const auto kept = std::filesystem::last_write_time(folder_ / "film.mpg.partial/chunk_00001.m2v");
    // So that it is there afterwards, too.
    std::filesystem::create_hard_link(folder_ / "film.mpg.partial/chunk_00001.m2v", folder_ / "kept.m2v");
    const auto resumed = run(begin + " --resume");
    EXPECT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_NE(resumed.output.find("film.mpg with frame 0: 45 of 127 are there"), std::string::npos) << resumed.output;
    EXPECT_EQ(std::filesystem::last_write_time(folder_ / "kept.m2v"), kept) << "it was not made again";

    make(start("--quiet --threads 2 --stats " + file("whole.json") + " -o " + file("whole.mpg")));
    EXPECT_TRUE(bytes("film.mpg") == bytes("whole.mpg"));
    json film = lasting(bytes("film.json")), whole = lasting(bytes("whole.json"));
    EXPECT_EQ(film.at("per_frame"), whole.at("per_frame"));
    for (const char* count : {"gather_points", "shadow_rays", "primary_rays", "gather_rays"})
        EXPECT_EQ(film.at("counts").at(count), whole.at("counts").at(count)) << count;
}

TEST_F(ChunksAtOnce, InterruptedOnesAreResumedByAnyOtherNumberOfThemSlow) {
    const std::string begin = start(direct_ + "--hold --frames 0:819 --threads 2 -o " + file("film.mpg"));
    int ended = 0;
    for (const auto& [chunks, signal] : {std::pair{"3", "TERM"}, {"2", "KILL"}, {"4", "INT"}}) {
        // When one more is whole, others are in the making.
        const std::string whole = "$(ls " + file("film.mpg.partial") + "/chunk_*.json 2> /dev/null | wc -l)";
        const auto outcome = run("n=" + whole + "; env --default-signal=INT " + begin + " --resume --chunks-at-once " +
                                 chunks + " & job=$!; while [ " + whole +
                                 " -le $n ]; do kill -0 $job 2> /dev/null || break; sleep 0.01; done; kill -" + signal +
                                 " $job 2> /dev/null; wait $job");
        if (outcome.status == 0) break;
        EXPECT_TRUE(outcome.status == 143 || outcome.status == 137 || outcome.status == 130) << outcome.output;
        const bool tells = outcome.output.find("of 820 frames; the same command with --resume goes on with frame ") !=
                           std::string::npos;
        EXPECT_EQ(tells, outcome.status != 137) << outcome.output;
        // What leads is a film, without those behind the first that is not whole.
        const std::string film = file("film.mpg.partial/film.mpg");
        if (tells && std::filesystem::exists(film)) {
            EXPECT_EQ(run("ffmpeg -v error -i " + film + " -f null -").output, "") << outcome.output;
        }
        ++ended;
    }
    make(begin + " --resume --chunks-at-once 3");
    make(start(direct_ + "--hold --frames 0:819 --quiet --threads 2 -o " + file("whole.mpg")));
    EXPECT_TRUE(bytes("film.mpg") == bytes("whole.mpg"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "film.mpg.partial"));
    if (ended == 0) GTEST_SKIP() << "each run was whole before its signal came";
}

TEST_F(ChunksAtOnce, AFilmEndsWithItsFirstThatIsNotWhole) {
    std::vector<app::ChunkFile> files;
    const auto add = [&](int index, bool whole) {
        app::ChunkFile chunk(folder_ / ("chunk_" + std::to_string(index) + ".m2v"),
                             {index, 10 * index, 10 * index + 9});
        if (whole) chunk.finish({});
        files.push_back(std::move(chunk));
        return app::leading_of(files, 2).size();
    };
    EXPECT_EQ(add(2, true), 1u);
    EXPECT_EQ(add(3, true), 2u);
    EXPECT_EQ(add(4, false), 3u);
    EXPECT_EQ(add(5, true), 3u) << "it lies behind one that is not whole";
    files.erase(files.begin() + 1);
    EXPECT_EQ(app::leading_of(files, 2).size(), 1u) << "there is a gap";
    EXPECT_EQ(app::leading_of(files, 1).size(), 0u);
}

TEST_F(ChunksAtOnce, OneThatFailsStopsTheOthersAndKeepsWhatIsWholeSlow) {
    // A frame of the third chunk cannot be written.
    std::filesystem::create_directories(folder_ / "f.120.png/mine");
    const std::string begin = start(direct_ + "--threads 2 --chunks-at-once 2 -o " + file("f.%03d.png"));
    const auto outcome = run(begin);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.output.find("f.120.png"), std::string::npos) << outcome.output;
    // On a busy machine the second chunk may still be in the making.
    const auto goes_on_with = [&](const char* frame) {
        return outcome.output.find(std::string("with --resume goes on with frame ") + frame) != std::string::npos;
    };
    EXPECT_TRUE(goes_on_with("82") || goes_on_with("41")) << outcome.output;
    std::filesystem::remove_all(folder_ / "f.120.png");
    const auto resumed = run(begin + " --resume");
    EXPECT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "f.120.png"));
}

TEST_F(ChunksAtOnce, AreAsManyAsCoresAskFor) {
    const auto planned = [&](const std::string& more) {
        const std::string text = run(start("--dry-run --within 0 -o " + file("f.mpg ") + more)).output;
        const std::size_t at = text.find("at once: "), begin = text.rfind('\n', at) + 1;
        return at == std::string::npos ? text : text.substr(begin, text.find('\n', at) - begin);
    };
    EXPECT_EQ(planned("--threads 2"), "1 chunk at once: 2 threads, 4 to a chunk");
    EXPECT_EQ(planned("--threads 1 --chunks-at-once 3"), "3 chunks at once: --chunks-at-once 3");
    EXPECT_EQ(planned("--threads 64 --frames 0:40"), "1 chunk at once: the film has no other");
    EXPECT_EQ(planned("--threads 64 --heatmap cut " + file("h.mkv")),
              "1 chunk at once: films beside it (--also, --heatmap) are made in order");
    const std::string many = planned("--threads 8"), more = planned("--threads 640");
    EXPECT_EQ(many.find("2 chunks at once: 8 threads, 4 to a chunk; memory allows "), 0u) << many;
    EXPECT_EQ(more.find("4 chunks at once: 640 threads, 4 to a chunk; the film has 4; memory allows "), 0u) << more;
}

/// Slow: a program under a sanitizer takes more memory than these allow.
TEST_F(ChunksAtOnce, AreAsManyAsMemoryAllowsSlow) {
    const auto planned = [&](const std::string& more) {
        const std::string text = run(start("--dry-run --within 0 -o " + file("f.mpg ") + more)).output;
        const std::size_t at = text.find("at once: "), begin = text.rfind('\n', at) + 1;
        return at == std::string::npos ? text : text.substr(begin, text.find('\n', at) - begin);
    };
    // Each further one takes some 50 MiB here.
    const auto allowed = [&](const std::string& memory) {
        const std::string text = planned("--threads 640 --memory " + memory);
        const int count = std::stoi(text.substr(text.rfind(' ')));
        EXPECT_EQ(std::stoi(text), std::min(count, 4)) << text;
        return count;
    };
    const int none = allowed("70M"), some = allowed("300M"), twice = allowed("600M");
    EXPECT_LT(none, 4);
    EXPECT_GE(twice - some, 300 / 60);
    EXPECT_LE(twice - some, 300 / 24);
}

}  // namespace
}  // namespace render2mpeg::test
