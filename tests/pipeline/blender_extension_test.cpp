#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/fixture.h"

/// The extension for Blender: its zip and repository, and what its engine does in the Blender that is installed.
namespace render2mpeg::test {
namespace {

using support::Outcome;

namespace fs = std::filesystem;

#define NEEDS_BLENDER_FOR_EXTENSIONS() \
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed"

/// Packed anew, so that the sources are what is tested.
std::string repository_in(const Folder& folder) {
    const Outcome packed =
        run((support::source_folder() / "scripts/extension").string() + " " + path(folder, "repository"));
    EXPECT_EQ(packed.status, 0) << packed.output;
    return path(folder, "repository");
}

/// A script of tests/blender with words of its own, for markers.blend. It names its own Blender to the program, whose
/// exports the one that serves all tests makes.
Outcome extended_blender(const Folder& folder, const std::string& name, const std::string& words,
                         const std::string& blender = support::installed_blender()) {
    const bool is_served = std::getenv("RENDER2MPEG_TEST_BLENDER") != nullptr;
    const std::string served = is_served ? "RENDER2MPEG_BLENDER=" + support::blender_words() + " " : "";
    std::ofstream(folder / "program") << "#!/bin/sh\necho \"$RENDER2MPEG_BLENDER\" >> " << path(folder, "named")
                                      << "\nRENDER2MPEG_PROGRAM= " << served << "exec " << program() << " \"$@\"\n";
    fs::permissions(folder / "program", fs::perms::owner_all);
    const Outcome outcome = support::users_blender(
        folder, path(folder, "markers.blend") + " -P " + support::blender_script(name) + " -- " + words,
        "RENDER2MPEG_PROGRAM=" + path(folder, "program") + " " + blender);
    EXPECT_EQ(run("sort -u " + path(folder, "named")).output, run("realpath $(command -v blender)").output);
    return outcome;
}

void make_markers(const Folder& folder) {
    const Outcome made = support::blender("-P " + support::blender_script("make_blends.py") + " -- " +
                                          folder.path().string() + " markers");
    ASSERT_EQ(made.status, 0) << made.output;
}

TEST(BlenderExtension, HasTheSameBytesEachTimeAndAnIndexThatTellsThem) {
    const Folder folder, other;
    const fs::path first = repository_in(folder), second = repository_in(other);
    const nlohmann::json row = nlohmann::json::parse(contents(first / "index.json")).at("data").at(0);
    const fs::path zip = first / row.at("archive_url").get<std::string>();
    EXPECT_EQ(contents(zip), contents(second / zip.filename()));
    EXPECT_EQ(contents(first / "index.html"), contents(second / "index.html"));
    EXPECT_EQ(fs::file_size(zip), row.at("archive_size").get<std::uintmax_t>());
    const Outcome sum = run("sha256sum " + zip.string());
    EXPECT_EQ("sha256:" + sum.output.substr(0, 64), row.at("archive_hash").get<std::string>());
    EXPECT_EQ(row.at("license"), nlohmann::json::array({"SPDX:GPL-3.0-or-later"}));
    // Whoever gets the zip gets the licences, and the sources with it.
    const Outcome listed = run("python3 -m zipfile --list " + zip.string());
    for (const char* name :
         {"LICENSE-Apache-2.0.txt", "LICENSE-GPL-3.0-or-later.txt", "blender_manifest.toml", "__init__.py"})
        EXPECT_NE(listed.output.find(std::string("render2mpeg/") + name + " "), std::string::npos) << listed.output;
}

TEST(BlenderExtension, TellsTheLicencesOfWhateverImportsBlender) {
    std::size_t files = 0;
    for (const char* place : {"blender", "tests/blender"})
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(support::source_folder() / place)) {
            if (entry.path().extension() != ".py") continue;
            const std::string text = contents(entry.path());
            if (text.find("import bpy") == std::string::npos && text.find("from bpy") == std::string::npos) continue;
            EXPECT_NE(text.find("# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later\n"), std::string::npos)
                << entry.path();
            ++files;
        }
    EXPECT_GE(files, 25u);
}

TEST(BlenderExtensionSlow, IsValidForTheBlenderThatIsInstalled) {
    NEEDS_BLENDER_FOR_EXTENSIONS();
    const Folder folder;
    const Outcome checked =
        run((support::source_folder() / "scripts/extension").string() + " " + path(folder, "repository") + " --check");
    EXPECT_EQ(checked.status, 0) << checked.output;
    const bool old = checked.output.find("not checked: Blender ") != std::string::npos;
    EXPECT_TRUE(old || checked.output.find("whose index says the same") != std::string::npos) << checked.output;
}

TEST(BlenderExtensionSlow, MakesStillsFilmsAndReportsOfMistakes) {
    NEEDS_BLENDER_FOR_EXTENSIONS();
    const Folder folder;
    make_markers(folder);
    const Outcome used =
        extended_blender(folder, "use_engine.py", repository_in(folder) + " " + folder.path().string());
    EXPECT_EQ(used.status, 0) << used.output;
    EXPECT_NE(used.output.find("ENGINE WORKS"), std::string::npos) << used.output;
}

TEST(BlenderExtensionSlow, GoesOnWithAFilmThatWasStopped) {
    NEEDS_BLENDER_FOR_EXTENSIONS();
    const Folder folder;
    make_markers(folder);
    const std::string words = repository_in(folder) + " " + folder.path().string();
    // Ctrl-C is for the whole process.
    const Outcome stopped = extended_blender(folder, "stop_engine.py", words + " 70 130 LOW signal", "blender");
    EXPECT_NE(stopped.output.find("ENGINE STOPPED"), std::string::npos) << stopped.output;
    const Outcome resumed = extended_blender(folder, "stop_engine.py", words + " 0 130 LOW signal");
    EXPECT_NE(resumed.output.find("ENGINE WENT ON"), std::string::npos) << resumed.output;
    // A chunk whose record named layers while Blender took them away is lit again.
    const bool is_resumed = resumed.output.find("resuming") != std::string::npos;
    EXPECT_TRUE(is_resumed || resumed.output.find("--resume: no frame was left") != std::string::npos)
        << resumed.output;
    // All frames are there, also those that were made before.
    for (int frame = 1; frame <= 130; ++frame)
        EXPECT_TRUE(fs::exists(folder / ("frames/f" +
                                         std::string(frame < 10    ? "000"
                                                     : frame < 100 ? "00"
                                                                   : "0") +
                                         std::to_string(frame) + ".png")))
            << frame;
}

TEST(BlenderExtensionSlow, BeginsAFilmAnewThatIsAnotherAndSaysSo) {
    NEEDS_BLENDER_FOR_EXTENSIONS();
    const Folder folder;
    make_markers(folder);
    const std::string words = repository_in(folder) + " " + folder.path().string();
    const Outcome stopped = extended_blender(folder, "stop_engine.py", words + " 4 20 LOW run");
    EXPECT_NE(stopped.output.find("ENGINE STOPPED"), std::string::npos) << stopped.output;
    const Outcome anew = extended_blender(folder, "stop_engine.py", words + " 0 20 DEFAULT run");
    EXPECT_NE(anew.output.find("ENGINE WENT ON"), std::string::npos) << anew.output;
    EXPECT_NE(anew.output.find("the film begins anew"), std::string::npos) << anew.output;
    EXPECT_TRUE(fs::exists(folder / "film.mpg"));
}

TEST(BlenderExtensionSlow, MakesAFilmItsFolderAndTellsMistakesByOperators) {
    NEEDS_BLENDER_FOR_EXTENSIONS();
    const Folder folder;
    make_markers(folder);
    const Outcome used =
        extended_blender(folder, "use_operators.py", repository_in(folder) + " " + folder.path().string());
    EXPECT_EQ(used.status, 0) << used.output;
    EXPECT_NE(used.output.find("ADDON WORKS"), std::string::npos) << used.output;
    // What was written for elsewhere needs no Blender.
    const Outcome elsewhere = run("PATH=" + support::binary_folder().string() +
                                  ":/usr/bin:/bin RENDER2MPEG_BLENDER=/nowhere " + path(folder, "elsewhere/render.sh"));
    EXPECT_EQ(elsewhere.status, 0) << elsewhere.output;
    EXPECT_EQ(contents(folder / "elsewhere/-it's; touch PWNED; $(touch PWNED).mpg"), contents(folder / "film.mpg"))
        << "the same film";
    EXPECT_FALSE(fs::exists(folder / "elsewhere/PWNED"));
}

}  // namespace
}  // namespace render2mpeg::test
