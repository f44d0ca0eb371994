#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/sampling.h"
#include "pipeline/fixture.h"

/// A film that is killed again and again comes out as if nothing had happened.
namespace render2mpeg::test {
namespace {

const std::string light = " --size 16x16 --samples 1 --gop 41 --threads 1 --quiet ",
                  direct = light + "--vpls 0 --tolerance fixed=10% --exposure 0 ";

/// Four chunks of 41 frames.
std::string scene_in(const Folder& folder) {
    std::ofstream(folder / "scene.json") << support::travel_scene(164);
    return path(folder, "scene.json");
}

/// Statistics without what another run measures otherwise: times, memory, and the photons that every run needs anew.
json lasting(const std::filesystem::path& file) {
    json s = json::parse(contents(file));
    for (const char* key : {"seconds", "passes", "effects", "peak_rss_mib", "command", "output"}) s.erase(key);
    json& counts = s["counts"];
    for (const char* key : {"photon_rays", "calibration_seconds", "sky_seconds", "layer_seconds"}) counts.erase(key);
    if (s["audit"].is_object()) s["audit"].erase("seconds");
    // Means are put together from two runs' means.
    for (const char* key : {"clamped_energy", "mean_error_scale"})
        counts[key] = std::round(1e9 * counts[key].get<double>());
    for (const char* key : {"luminance", "photon_energy", "photon_energy_lost"}) counts.erase(key);
    for (json& frame : s["per_frame"])
        for (const char* time : {"seconds", "seconds_by_stage"}) frame.erase(time);
    return s;
}

/// Begins `command` and ends it with a signal after some seconds, if it is not done by then.
support::Outcome killed(const std::string& command, const std::string& signal, double seconds) {
    // A command that a script begins in the background ignores SIGINT.
    return run("env --default-signal=INT " + command + " & job=$!; sleep " + std::to_string(seconds) + "; kill -" +
               signal + " $job 2> /dev/null; wait $job");
}

/// Renders with one of the signals after the other, at moments drawn by the seed, until it is done; at the latest after
/// so many kills nothing disturbs it. Returns how many runs were ended by a signal.
int render_killed(const std::string& render, const std::vector<std::string>& signals, std::uint64_t seed, int kills,
                  double longest) {
    int ended = 0;
    for (int i = 0; i < kills; ++i) {
        const double after = longest * core::uniform(seed, static_cast<std::uint64_t>(i), 0, 0);
        const auto outcome = killed(render + " --resume", signals[static_cast<std::size_t>(i) % signals.size()], after);
        if (outcome.status == 0) return ended;
        EXPECT_TRUE(outcome.status == 130 || outcome.status == 143 || outcome.status == 137)
            << outcome.status << ": " << outcome.output;
        ++ended;
    }
    const auto outcome = run(render + " --resume");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return ended;
}

TEST(Resume, AFilmThatIsKilledAgainAndAgainHasTheSameBytesSlow) {
    const Folder folder;
    const std::string start = program() + " render -y --hold " + scene_in(folder) + light;
    const auto output = [&](const std::string& name) {
        return "-o " + path(folder, name + ".mpg") + " --stats " + path(folder, name + ".json");
    };
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(run(start + output("whole")).status, 0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (const char* signal : {"INT", "TERM", "KILL"}) {
        const std::string name = std::string("film") + signal;
        if (render_killed(start + output(name), {signal}, 7, 4, 0.5 * seconds) == 0)
            GTEST_SKIP() << "each run was whole before its signal came";
        EXPECT_TRUE(contents(folder / (name + ".mpg")) == contents(folder / "whole.mpg")) << signal;
        EXPECT_TRUE(lasting(folder / (name + ".json")) == lasting(folder / "whole.json")) << signal;
    }
    EXPECT_EQ(folder.entries(), 9u) << "no leftover stays";
}

/// What there is once a film of ten chunks was killed behind its first, or a few more on a busy machine.
class Interrupted : public testing::Test {
  protected:
    void SetUp() override {
        const std::string record = path(folder_, "film.mpg.partial/chunk_00000.json");
        const auto outcome = run(start_ + " & job=$!; while [ ! -s " + record +
                                 " ]; do kill -0 $job || exit 99; sleep 0.01; done; kill -KILL $job; wait $job");
        if (outcome.status == 0) GTEST_SKIP() << "it was whole before the signal came";
        ASSERT_EQ(outcome.status, 137) << outcome.output;
        while (std::filesystem::exists(folder_ / ("film.mpg.partial/chunk_0000" + std::to_string(chunks_) + ".json")))
            ++chunks_;
    }
    std::string stream(int chunk) const {
        return contents(folder_ / ("film.mpg.partial/chunk_0000" + std::to_string(chunk) + ".m2v"));
    }
    /// The line that refuses; empty where it went on.
    std::string refusal(const std::string& more) const {
        const auto outcome = run(start_ + " --resume " + more);
        return outcome.status == 0 ? std::string() : outcome.output;
    }

    const Folder folder_;
    int chunks_ = 0;
    const std::string start_ = program() + " render -y --hold " + scene_in(folder_) + direct +
                               "--hold --frames 0:409 -o " + path(folder_, "film.mpg");
};

TEST_F(Interrupted, FilmsAreResumedByNoOtherRunThanTheirOwnSlow) {
    const std::string first = stream(0);
    ASSERT_FALSE(first.empty());
    const auto refused = [&](const std::string& more, const std::string& words) {
        for (const char* way : {"", " --dry-run --within 0"}) {
            const std::string line = refusal(more + way);
            EXPECT_NE(line.find("resuming " + path(folder_, "film.mpg") + ": " + words), std::string::npos) << line;
            EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
        }
    };
    refused("--quantiser 6", "--quantiser was not given and is 6");
    refused("--clamp none", "--clamp was not given and is none");
    refused("--isa sse2", "instruction set was ");

    const std::filesystem::path scene = folder_ / "scene.json", manifest = folder_ / "film.mpg.partial/manifest.json";
    const std::string before = contents(scene), identity = contents(manifest);
    std::ofstream(scene, std::ios::app) << " ";
    refused("", "the input " + scene.string() + " has changed");
    std::ofstream(scene, std::ios::trunc) << before;

    json other = json::parse(identity);
    other["identity"]["render2mpeg"] = "0.0.9";
    std::ofstream(manifest, std::ios::trunc) << other;
    refused("", "render2mpeg was 0.0.9 and is ");
    std::ofstream(manifest, std::ios::trunc) << "{";
    refused("", "manifest.json is damaged in ");
    std::ofstream(manifest, std::ios::trunc) << identity;

    EXPECT_EQ(stream(0), first) << "nothing was touched";
    EXPECT_EQ(refusal("--stats " + path(folder_, "s.json")), "") << "this may change";
    EXPECT_EQ(json::parse(contents(folder_ / "s.json")).at("frames"), 410);
}

TEST_F(Interrupted, ChunksThatAreDamagedAreRenderedAgainSlow) {
    std::string damaged = stream(0);
    ASSERT_GT(damaged.size(), 100u);
    damaged[100] = static_cast<char>(damaged[100] ^ 1);
    std::ofstream(folder_ / "film.mpg.partial/chunk_00000.m2v", std::ios::binary | std::ios::trunc) << damaged;
    EXPECT_EQ(refusal(""), "");
    const std::string resumed = contents(folder_ / "film.mpg");
    ASSERT_EQ(run(start_).status, 0);
    EXPECT_EQ(contents(folder_ / "film.mpg"), resumed);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "film.mpg.partial"));
}

/// A film of one chunk, ended behind some of its frames.
class InAChunk : public testing::Test {
  protected:
    void SetUp() override {
        std::ofstream(folder_ / "scene.json") << support::travel_scene(96);
        make_whole();
    }
    void make_whole() const { ASSERT_EQ(run(start_ + "whole.mpg --stats " + path(folder_, "whole.json")).status, 0); }
    /// Ends it by a signal once more than `beyond` frames are kept, as its state says behind a header of 24 bytes.
    /// Returns how many.
    std::int64_t end_by(const std::string& signal, std::int64_t beyond = 0) {
        const std::string count = "$(od -An -t d8 -j 24 -N 8 " + state_ + " 2> /dev/null)";
        const auto outcome =
            run("env --default-signal=INT " + start_ + "film.mpg --resume & job=$!; while n=" + count +
                "; [ ${n:-0} -le " + std::to_string(beyond) +
                " ]; do kill -0 $job || exit 99; sleep 0.03; done; kill -" + signal + " $job; wait $job");
        EXPECT_TRUE(outcome.status == 130 || outcome.status == 143 || outcome.status == 137) << outcome.output;
        said_ = outcome.output;
        std::int64_t lit = 0;
        std::ifstream state(state_, std::ios::binary);
        state.seekg(24);
        state.read(reinterpret_cast<char*>(&lit), sizeof lit);
        return lit;
    }
    /// What a run says that goes on and makes the film.
    std::string go_on() const {
        const auto outcome = run(start_ + "film.mpg --resume --stats " + path(folder_, "film.json"));
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        EXPECT_TRUE(contents(folder_ / "film.mpg") == contents(folder_ / "whole.mpg"));
        EXPECT_FALSE(std::filesystem::exists(folder_ / "film.mpg.partial"));
        return outcome.output;
    }

    const Folder folder_;
    std::string said_;  ///< by the run that was ended
    const std::string state_ = path(folder_, "film.mpg.partial/chunk_00000.state");
    std::string start_ = program() + " render -y --hold " + path(folder_, "scene.json") +
                         " --size 32x32 --gop 96 --threads 1 -o " + folder_.path().string() + "/";
};

TEST_F(InAChunk, LitFramesAreKeptWhateverEndsARunSlow) {
    std::int64_t lit = 0;
    for (const char* signal : {"INT", "KILL", "TERM"}) {
        const std::int64_t now = end_by(signal, lit);
        EXPECT_GT(now, lit) << signal;
        lit = now;
    }
    const std::string said = go_on(), there = std::to_string(lit);
    EXPECT_NE(said.find("film.mpg with frame " + there + ": " + there + " of 96 are there"), std::string::npos) << said;
    EXPECT_TRUE(lasting(folder_ / "film.json") == lasting(folder_ / "whole.json"));
}

/// Smoke that drifts for two frames, and then hangs where its light stays.
class InAChunkOfSmoke : public InAChunk {
  protected:
    void SetUp() override {
        json scene = json::parse(support::travel_scene(12));
        scene["lights"].erase(1);
        scene["volumes"] = json::parse(R"([{ "size": 1.5, "density": 2, "keys": [
            { "at": 0, "position": [0, 1, 0] }, { "at": 0.04, "position": [0.2, 1, 0] } ] }])");
        std::ofstream(folder_ / "scene.json") << scene;
        make_whole();
    }
};

TEST_F(InAChunkOfSmoke, ASignalCostsTheFrameAtHandSlow) {
    for (const std::int64_t beyond : {0, 3}) {
        const std::int64_t lit = end_by("TERM", beyond);
        ASSERT_GT(lit, beyond);
        const std::string words = "interrupted after ";
        const std::size_t at = said_.find(words);
        ASSERT_NE(at, std::string::npos) << said_;
        EXPECT_LT(std::stoll(said_.substr(at + words.size())) - lit, 2) << said_;
    }
    go_on();
    EXPECT_TRUE(lasting(folder_ / "film.json") == lasting(folder_ / "whole.json"));
}

/// Two eyes, each with its own last frame, glare and blur.
class InAChunkForTwoEyes : public InAChunk {
  protected:
    void SetUp() override {
        json scene = json::parse(support::travel_scene(24));
        scene["stereo"] = "side-by-side";
        scene["glare"] = "static";
        scene["shutter"] = 180;
        std::ofstream(folder_ / "scene.json") << scene;
        make_whole();
    }
};

TEST_F(InAChunkForTwoEyes, LitFramesAreKeptSlow) {
    for (const std::int64_t beyond : {1, 5}) EXPECT_GT(end_by("TERM", beyond), beyond);
    go_on();
    EXPECT_TRUE(lasting(folder_ / "film.json") == lasting(folder_ / "whole.json"));
}

/// Frames of an animation of this tree.
struct Shot {
    const char* name;
    const char* frames;
    std::int64_t beyond;  ///< of how many it is ended at the earliest
};

/// Things that move and deform, and a view that changes: at frame 36, which the run that goes on does not light.
class InAChunkOfAnAnimation : public InAChunk, public testing::WithParamInterface<Shot> {
  protected:
    void SetUp() override {
        start_ = program() + " render -y --hold " + film(GetParam().name) +
                 " --size 16x16 --samples 1 --threads 2 --frames " + GetParam().frames + " -o " +
                 folder_.path().string() + "/";
        make_whole();
    }
};

TEST_P(InAChunkOfAnAnimation, LitFramesAreKeptSlow) {
    EXPECT_GT(end_by("KILL", GetParam().beyond), GetParam().beyond);
    go_on();
    EXPECT_TRUE(lasting(folder_ / "film.json") == lasting(folder_ / "whole.json"));
}

INSTANTIATE_TEST_SUITE_P(Shots, InAChunkOfAnAnimation,
                         testing::Values(Shot{"character", "0:11", 3}, Shot{"flash_cut", "33:40", 4}),
                         [](const auto& shot) { return std::string(shot.param.name); });

TEST_F(InAChunk, LitFramesThatAreDamagedAreLitAnewAndSaidSlow) {
    EXPECT_GT(end_by("KILL"), 0);
    std::string state = contents(state_);
    state[state.size() / 2] = static_cast<char>(state[state.size() / 2] ^ 1);
    std::ofstream(state_, std::ios::binary | std::ios::trunc) << state;
    const std::string said = go_on();
    EXPECT_NE(said.find(state_ + " is damaged, or another film's: its frames are lit anew"), std::string::npos) << said;
    EXPECT_GT(end_by("KILL"), 0);
    std::filesystem::resize_file(folder_ / "film.mpg.partial/chunk_00000.lit", 100);
    EXPECT_NE(go_on().find("has lost its pictures: its frames are lit anew"), std::string::npos);
}

TEST_F(InAChunk, PipesInPlaceOfLitFramesAreRemovedSlow) {
    for (const char* ending : {"state", "lit"}) {
        EXPECT_GT(end_by("KILL"), 0);
        ASSERT_EQ(run("cd " + path(folder_, "film.mpg.partial") + " && rm chunk_00000." + ending +
                      " && mkfifo chunk_00000." + ending)
                      .status,
                  0);
        EXPECT_NE(go_on().find("its frames are lit anew"), std::string::npos) << ending;
    }
}

TEST_F(Interrupted, FilmsSayHowToGoOnAndWhereTheyDo) {
    std::string loud = start_;
    loud.erase(loud.find(" --quiet"), 8);
    // Behind whole chunks lie the lit frames of the next, as its state says behind a header of 24 bytes.
    std::int64_t lit = 0;
    std::ifstream state(folder_ / ("film.mpg.partial/chunk_0000" + std::to_string(chunks_) + ".state"),
                        std::ios::binary);
    state.seekg(24);
    state.read(reinterpret_cast<char*>(&lit), sizeof lit);
    const std::string done = std::to_string(41 * chunks_ + lit);
    const auto said = [&](const std::string& words, const std::string& command) {
        const std::string output = run(command).output;
        return output.find(words) != std::string::npos ? "" : output;
    };
    EXPECT_EQ(said(done + " of 410 frames are left of an earlier run, which goes on",
                   loud + " --resume --dry-run --within 0"),
              "");
    EXPECT_EQ(said(done + " of 410 frames are left of an earlier run, and given up", loud + " --dry-run --within 0"),
              "");
    EXPECT_EQ(said("film.mpg with frame " + done + ": " + done + " of 410 are there", loud + " --resume"), "");
}

TEST(Resume, IsTheWayOnAfterCtrlC) {
    const Folder folder;
    std::string start = support::program_at_terminal() + " render -y --hold " + scene_in(folder) + light +
                        "--hold --frames 0:9999 -o " + path(folder, "f.mpg");
    start.erase(start.find(" --quiet"), 8);
    const auto outcome = run(start + " & job=$!; while [ ! -s " + path(folder, "f.mpg.partial/chunk_00000.json") +
                             " ]; do kill -0 $job || exit 99; sleep 0.01; done; kill -INT $job; wait $job");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_NE(outcome.output.find("of 10000 frames; the same command with --resume goes on with frame "),
              std::string::npos)
        << outcome.output;
}

TEST(Resume, BeginsAFilmOfWhichNothingIsLeft) {
    const Folder folder;
    const auto outcome = run(program() + " render -y --hold " + plain_film() +
                             " --size 16x16 --samples 1 --frames 0:1 --resume -o " + path(folder, "f.mpg"));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.output.find("--resume: no frame was left of "), std::string::npos) << outcome.output;
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(Resume, GivesAFilmItsNameThatCouldNotHaveItBeforeSlow) {
    const Folder folder;
    const std::string start =
        program() + " render -y --hold " + scene_in(folder) + direct + "-o " + path(folder, "film.mpg");
    // Somebody takes its name while it is made.
    const auto outcome = run(start + " --stats " + path(folder, "s.json") + " & job=$!; while [ ! -e " +
                             path(folder, "film.mpg.partial/chunk_00000.m2v") +
                             " ]; do kill -0 $job || exit 99; sleep 0.01; done; mkdir " + path(folder, "film.mpg") +
                             "; touch " + path(folder, "film.mpg/mine") + "; wait $job");
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_NE(outcome.output.find("writing " + path(folder, "film.mpg") + ": "), std::string::npos) << outcome.output;
    const json told = json::parse(contents(folder / "s.json"));
    EXPECT_EQ(told.at("frames"), 164) << "what was measured is not lost";
    EXPECT_EQ(told.at("complete"), false);
    std::filesystem::remove_all(folder / "film.mpg");
    EXPECT_EQ(run(start + " --resume").status, 0);
    const std::string resumed = contents(folder / "film.mpg");
    ASSERT_EQ(run(start + " -y").status, 0);
    EXPECT_EQ(contents(folder / "film.mpg"), resumed);
}

/// Slow: other outputs, other settings, other scenes, many more moments.
TEST(Resume, FramesThatAreNotCodedAreKeptSlow) {
    const Folder folder;
    const std::string start = program() + " render -y --hold " + scene_in(folder) + light + "-o ";
    const std::string film = path(folder, "film.y4m"), record = film + ".partial/chunk_00000.json";
    const auto killed = run(start + film + " & job=$!; while [ ! -s " + record +
                            " ]; do kill -0 $job || exit 99; sleep 0.01; done; kill -KILL $job; wait $job");
    ASSERT_EQ(killed.status, 137) << killed.output;
    const auto resumed = run(start + film + " --resume");
    ASSERT_EQ(resumed.status, 0) << resumed.output;
    ASSERT_EQ(run(start + path(folder, "whole.y4m")).status, 0);
    EXPECT_TRUE(contents(film) == contents(folder / "whole.y4m"));
}

TEST(ResumeSlow, EveryKindOfOutputComesOutAsIfNothingHadHappened) {
    const Folder folder;
    const auto render = [&](const std::string& place) {
        std::filesystem::create_directory(folder / place);
        const std::string start = program() + " render -y --hold " + path(folder, "scene.json") +
                                  " --size 16x16 --samples 1 --gop 41 --threads 1 --quiet --frames 0:43 ",
                          to = path(folder, place);
        return std::vector<std::string>{
            start + "--bitrate 200k -o " + to + "/rate.mpg --heatmap tolerance " + to +
                "/heat.mkv --heatmap quantiser " + to + "/quantiser.m2v",
            start + "--audit 5 --cache on --aov " + to + " -o " + to + "/layers.mp4",
            start + "-o " + to + "/plain.y4m",
            start + "-o " + to + "/f.%03d.png",
            start + "-o " + to + "/p.%03d.exr --tolerance fixed=50%",
            start + "-o " + to + "/f.ts",
            start + "-o " + to + "/f.vob",
            start + "-o " + to + "/f.mkv --codec hevc",
            start + "-o " + to + "/f.mov",
            start + "-o " + to + "/f.gif",
        };
    };
    scene_in(folder);
    const std::vector<std::string> whole = render("whole"), cut = render("cut");
    for (const std::string& command : whole) ASSERT_EQ(run(command).status, 0) << command;
    int ended = 0;
    for (std::size_t i = 0; i < cut.size(); ++i)
        ended += render_killed(cut[i], {"INT", "TERM", "KILL"}, 11 + i, 6, 0.5);
    if (ended == 0) GTEST_SKIP() << "films end before any signal comes";
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "whole")) {
        const std::filesystem::path name = entry.path().filename();
        EXPECT_TRUE(contents(entry.path()) == contents(folder / "cut" / name.string())) << name;
        ++files;
    }
    EXPECT_EQ(files, 1 + 2 + 44 + 1 + 1 + 44 + 44 + 44 + 5u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "cut"), std::filesystem::directory_iterator{}),
              static_cast<std::ptrdiff_t>(files));
}

}  // namespace
}  // namespace render2mpeg::test
