#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/fixture.h"

/// Modules that are missing are told before any light is found.
namespace render2mpeg::test {
namespace {

namespace fs = std::filesystem;

/// A program that finds all modules but some.
class WithoutModules : public testing::Test {
  protected:
    /// The program's command, with a module folder that lacks these.
    std::string program_without(const std::vector<std::string>& missing) {
        fs::create_directories(folder_ / "modules");
        for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(program()).parent_path() / "modules")) {
            const std::string name = entry.path().filename().string();
            const fs::path link = folder_ / "modules" / name;
            fs::remove(link);
            bool kept = true;
            for (const std::string& part : missing) kept = kept && name != file_of(part);
            if (kept) fs::create_symlink(entry.path(), link);
        }
        if (!fs::exists(folder_ / "render2mpeg")) fs::copy_file(program(), folder_ / "render2mpeg");
        return "RENDER2MPEG_MODULES=" + path(folder_, "modules") + " " + path(folder_, "render2mpeg");
    }
    static std::string file_of(const std::string& part) { return "render2mpeg_" + part + "_module.so"; }

    Folder folder_;
};

const std::string small = " --size 64x64 --frames 0:0 --tolerance fixed=20% --samples 1 ";

TEST_F(WithoutModules, EveryOutputIsRefusedBeforeAnyFrameIsLit) {
    struct Case {
        std::string output, missing;
    };
    for (const auto& [output, missing] : std::vector<Case>{{"f.mpg", "av"},
                                                           {"f.m2v", "av"},
                                                           {"f.ts", "av"},
                                                           {"f.mp4", "av"},
                                                           {"f.mkv --codec av1", "av"},
                                                           {"f.y4m --heatmap cut OUT/h.mpg", "av"},
                                                           {"f%04d.png", "image"},
                                                           {"f.y4m --last-frame OUT/last.png", "image"},
                                                           {"f.mpg --report OUT/r.html", "image"},
                                                           {"f%04d.exr", "exr"},
                                                           {"f.y4m --aov OUT/layers", "exr"}}) {
        const Folder out;
        std::string words = " -o OUT/" + output;
        for (std::size_t at; (at = words.find("OUT")) != std::string::npos;) words.replace(at, 3, out.path().string());
        const auto told = run(program_without({missing}) + " render " + film("cornell") + small + words);
        EXPECT_EQ(told.status, 1) << words << ": " << told.output;
        EXPECT_NE(told.output.find(file_of(missing)), std::string::npos) << words << ": " << told.output;
        EXPECT_EQ(std::count(told.output.begin(), told.output.end(), '\n'), 1) << told.output;
        // The work folder is made before the exposure is measured.
        EXPECT_EQ(out.entries(), 0u) << words;
    }
    const auto streamed = run(program_without({"av"}) + " render " + film("cornell") + small + "-o - --as m2v | wc -c");
    EXPECT_NE(streamed.output.find(file_of("av")), std::string::npos) << streamed.output;
    EXPECT_NE(streamed.output.find("\n0\n"), std::string::npos) << streamed.output;
}

TEST_F(WithoutModules, FramesOfOthersAreNotCodedInVain) {
    const Folder out;
    write_frames(path(out, "in.y4m"), 32, 16, "25:1", "1:1", 2);
    const auto told = run(program_without({"av"}) + " encode " + path(out, "in.y4m") + " -o " + path(out, "f.m2v"));
    EXPECT_EQ(told.status, 1);
    EXPECT_NE(told.output.find(file_of("av")), std::string::npos) << told.output;
    EXPECT_EQ(out.entries(), 1u);
}

TEST_F(WithoutModules, AFilmOfUsualTexturesNeedsNone) {
    const Folder out;
    const auto made = run(program_without({"av", "image", "exr", "draco"}) + " render " + film("cornell") + small +
                          "--quiet -o " + path(out, "f.y4m"));
    EXPECT_EQ(made.status, 0) << made.output;
}

TEST_F(WithoutModules, AReaderThatLacksItsModuleSaysSo) {
    const Folder out;
    const auto texture = [&](const std::string& name) {
        std::ofstream(out / "film.json") << R"({"size": [32, 24], "frames": 1, "sky": {"image": ")" << name << R"("},
            "objects": [{"shape": "box", "size": 1}]})";
        return run(program_without({"image"}) + " render " + path(out, "film.json") + small + "--quiet -o " +
                   path(out, "f.y4m"))
            .output;
    };
    // A TGA file of one pixel, which OpenImageIO reads.
    std::string tga(18, '\0');
    tga[2] = 2;
    tga[12] = tga[14] = 1;
    tga[16] = 24;
    std::ofstream(out / "sky.tga") << tga << "abc";
    const std::string told = texture("sky.tga");
    EXPECT_NE(told.find("opening " + file_of("image") + ": not found in"), std::string::npos) << told;
    EXPECT_EQ(told.find("damaged"), std::string::npos) << told;

    write_frames(path(out, "in.y4m"), 32, 16, "25:1", "1:1", 2);
    ASSERT_EQ(run(program() + " encode " + path(out, "in.y4m") + " --quiet -o " + path(out, "in.mpg")).status, 0);
    const std::string info = run(program_without({"av"}) + " info " + path(out, "in.mpg")).output;
    EXPECT_NE(info.find("opening " + file_of("av") + ": not found in"), std::string::npos) << info;
    EXPECT_EQ(info.find("damaged"), std::string::npos) << info;
}

TEST(Causes, AReaderThatDoesNotStartIsNamed) {
    const Folder out;
    std::ofstream(out / "plain") << "no program";
    const auto told = [&](const std::string& reader) {
        return run("RENDER2MPEG_PROGRAM=" + reader + " " + program() + " render " + film("cornell") + small + "-o " +
                   path(out, "f.y4m"));
    };
    for (const auto& [reader, cause] : {std::pair(path(out, "plain"), std::string("Permission denied")),
                                        std::pair(path(out, "none"), std::string("No such file")),
                                        std::pair(std::string("/bin/false"), std::string("does not start"))}) {
        const auto line = told(reader);
        EXPECT_EQ(line.status, 1);
        EXPECT_NE(line.output.find(cause), std::string::npos) << line.output;
        EXPECT_NE(line.output.find(reader), std::string::npos) << line.output;
        EXPECT_EQ(line.output.find("damaged"), std::string::npos) << line.output;
    }
}

TEST(Causes, ThreadsAndMemoryThatDoNotFitAreToldInOneLineSlow) {
    const Folder out;
    const auto told = [&](const std::string& option) {
        return run(program() + " render " + film("cornell") + small + option + " -o " + path(out, "f.y4m") + " -y");
    };
    EXPECT_EQ(told("--quiet --threads 0").output, "") << "one thread per core";
    EXPECT_NE(told("--threads 1024").output.find("--threads 1024: this machine has "), std::string::npos);
    EXPECT_NE(told("--threads -1").output.find("expected a number from 0 to 1024"), std::string::npos);
    const auto small_memory = told("--memory 20M");
    EXPECT_EQ(small_memory.status, 1);
    EXPECT_NE(small_memory.output.find("and --memory allows 20 MiB"), std::string::npos) << small_memory.output;
    EXPECT_EQ(std::count(small_memory.output.begin(), small_memory.output.end(), '\n'), 1) << small_memory.output;
}

}  // namespace
}  // namespace render2mpeg::test
