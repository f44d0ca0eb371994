#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <string>

#include "pipeline/fixture.h"

/// Exports of .blend files that end early, by stand-ins for Blender.
namespace render2mpeg::test {
namespace {

using support::Outcome;

namespace fs = std::filesystem;

/// A .blend, and a program in Blender's place that does as `script` says in its folder.
class BlenderStandIn {
  public:
    explicit BlenderStandIn(const std::string& script) {
        std::ofstream(folder_ / "film.blend") << "BLENDER";
        std::ofstream(folder_ / "blender") << "#!/bin/sh\ncd " << folder_.path().string() << "\n" << script << "\n";
        fs::permissions(folder_ / "blender", fs::perms::owner_all);
    }
    Outcome run_with(const std::string& program, const std::string& more) const {
        return run("export RENDER2MPEG_BLENDER=" + path(folder_, "blender") + "; cd " + folder_.path().string() + "; " +
                   program + " plan --quiet --within 0 " + path(folder_, "film.blend") + more);
    }
    fs::path operator/(const std::string& name) const { return folder_ / name; }

  private:
    Folder folder_;
};

class BlendExportsAtSignals : public testing::TestWithParam<const char*> {};

TEST_P(BlendExportsAtSignals, EndWithAllThatTheyStarted) {
    const BlenderStandIn film("sleep 60 & echo $! > new; mv new child; wait; touch waited");
    const std::string signal = GetParam();
    const Outcome said =
        film.run_with(support::program_at_terminal(),
                      " > said 2>&1 & p=$!; while [ ! -e child ]; do sleep 0.1; done; kill -" + signal +
                          " $p; wait $p; echo status $?; timeout 30 sh -c 'while grep -q sleep "
                          "/proc/$(cat child)/cmdline; do sleep 0.1; done' || echo it sleeps");
    const std::map<std::string, std::string> statuses{{"INT", "130"}, {"TERM", "143"}, {"HUP", "129"}};
    EXPECT_EQ(said.output.substr(0, 11), "status " + statuses.at(signal) + "\n") << said.output;
    EXPECT_EQ(said.output.find("it sleeps"), std::string::npos) << said.output;
    EXPECT_FALSE(fs::exists(film / "waited"));
    EXPECT_FALSE(fs::exists(film / "film.blend.export"));
    EXPECT_NE(contents(film / "said").find("film.blend: interrupted"), std::string::npos) << contents(film / "said");
}

INSTANTIATE_TEST_SUITE_P(Signals, BlendExportsAtSignals, testing::Values("INT", "TERM", "HUP"),
                         [](const auto& signal) { return signal.param; });

TEST(BlendExports, ThatCrashKeepTheLogAndSayItsEnd) {
    const BlenderStandIn film("echo the first; echo the second; echo the third; echo the last >&2; exit 11");
    const Outcome said = film.run_with(program(), "");
    EXPECT_EQ(said.status, 1);
    const std::string log = (film / "film.blend.export/blender.log").string();
    EXPECT_EQ(said.output, "render2mpeg: reading " + (film / "film.blend").string() +
                               ": Blender crashed while it exported it; its last words, of " + log +
                               ": the second / the third / the last\n");
    EXPECT_NE(contents(log).find("the first\n"), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(film / "film.blend.export"), fs::directory_iterator()), 1);
}

/// Writes an export of these files to its folder.
std::string exporting(const std::string& film, const std::string& uses) {
    return "while [ \"$1\" != -- ]; do shift; done\nprintf '%s' '" + film + "' > \"$3/film.json\"\nprintf '%s' '" +
           R"({"blender": "0", "lost": [], "uses": [)" + uses + "]}' > \"$3/export.json\"";
}

TEST(BlendExports, TellTheirStepsSlow) {
    const BlenderStandIn film(
        "while [ \"$1\" != -- ]; do shift; done\necho 'frame 3 of 72' > \"$3/step\"; sleep 3; exit 1");
    const Outcome said = run("export RENDER2MPEG_BLENDER=" + (film / "blender").string() + "; script -qec '" +
                             program() + " plan --within 0 " + (film / "film.blend").string() + "' /dev/null");
    EXPECT_NE(said.output.find("Blender exports the scene: frame 3 of 72"), std::string::npos) << said.output;
}

TEST(BlendExports, OfFilesThatChangeNameThem) {
    const BlenderStandIn film(exporting("{}", R"(["/proc/self/environ", 0, 1])"));
    const Outcome said = film.run_with(program(), "");
    EXPECT_EQ(said.status, 1);
    EXPECT_NE(said.output.find("film.blend: it uses /proc/self/environ, which changes while it is exported"),
              std::string::npos)
        << said.output;
}

TEST(BlendExports, ThatAreNoFilmsAreRefusedByTheNameOfTheScene) {
    const BlenderStandIn film(exporting(R"({"frames": 1, "size": [65536, 4]})", ""));
    const Outcome said = film.run_with(program(), "");
    EXPECT_EQ(said.status, 1);
    EXPECT_NE(said.output.find("film.blend: its export by Blender: size[0]: expected"), std::string::npos)
        << said.output;
    EXPECT_EQ(said.output.find("film.json"), std::string::npos) << said.output;
}

TEST(BlendExports, ThatWereKilledAreRemovedByLaterOnes) {
    const BlenderStandIn film(exporting("{}", ""));
    const fs::path dead = film / "film.blend.export/0123456789abcdef.17", young = film / "film.blend.export/fedc.18";
    for (const fs::path& folder : {dead, young}) fs::create_directories(folder);
    std::ofstream(dead / "scene.glb") << "half of it";
    fs::last_write_time(dead, fs::file_time_type::clock::now() - std::chrono::hours(25));
    film.run_with(program(), "");
    EXPECT_FALSE(fs::exists(dead));
    EXPECT_TRUE(fs::exists(young)) << "another run may be making it";
}

TEST(BlendFilesThatUseSlow, WhatIsNoPlainFileAreRefusedByItsName) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const Folder folder;
    const Outcome made =
        support::blender("-P " + support::blender_script("make_users_of_files.py") + " -- " + folder.path().string());
    ASSERT_EQ(made.status, 0) << made.output;
    const std::pair<const char*, const char*> films[] = {{"image", "picture.png"},
                                                         {"volume", "smoke.vdb"},
                                                         {"cache", "moves.mdd"},
                                                         {"sound", "voice.wav"},
                                                         {"library", "part.blend"}};
    for (const auto& [film, name] : films) {
        fs::remove(folder / name);
        // A pipe would keep Blender waiting, and a device busy, for an hour.
        const bool is_device = std::string(film) == "image";
        ASSERT_EQ(run((is_device ? "ln -s /dev/zero " : "mkfifo ") + path(folder, name)).status, 0);
        const Outcome said =
            run("timeout 200 " + program() + " plan --quiet --within 0 " + path(folder, film + std::string(".blend")));
        EXPECT_EQ(said.status, 1);
        EXPECT_NE(said.output.find(film + std::string(".blend: it uses ") + path(folder, name) + ", which is a " +
                                   (is_device ? "device" : "pipe") + "; plain files alone are read"),
                  std::string::npos)
            << said.output;
    }
}

}  // namespace
}  // namespace render2mpeg::test
