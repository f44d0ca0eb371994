#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "app/experiments/beside_cycles.h"
#include "pipeline/fixture.h"

/// `render2mpeg compare --beside cycles`.
namespace render2mpeg::test {
namespace {

json window_of(int first, double times, double flicker, const char* beyond) {
    const json equal{{"times", times}, {"flicker", flicker}, {"beyond", beyond}};
    return {{"first", first}, {"last", first + 2}, {"equal", {{"4", equal}}}};
}

std::set<std::string> names_in(const Folder& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        names.insert(entry.path().filename().string());
    return names;
}

TEST(BesideCycles, SaysWhoIsBetterWhere) {
    json found;
    found["windows"] = {window_of(0, 3.1, 0.5, ""), window_of(40, 0.4, 0.9, ""), window_of(80, 0.9, 0.9, ">")};
    found["all"] = window_of(0, 3.14, 0.52, "");
    EXPECT_EQ(app::sentence_of_peers(found),
              "Beside Cycles with a denoiser, at quantiser 4 your film takes 3.1 times less CPU at equal quality, and "
              "has 0.5 times the flicker. Cycles with a denoiser would be better in frames 40 to 42.");
    found["windows"] = json::array({window_of(0, 0.5, 1, "")});
    found["all"] = window_of(0, 0.5, 1.0, "");
    EXPECT_NE(app::sentence_of_peers(found).find("takes 2.0 times the CPU at equal quality"), std::string::npos);
    found["all"] = window_of(0, 2.0, 0.5, ">");
    EXPECT_NE(
        app::sentence_of_peers(found).find("the best takes 2.0 times your film's CPU and has 2.0 times its flicker"),
        std::string::npos);
    found["all"] = window_of(0, 2.0, 0, ">");
    EXPECT_EQ(app::sentence_of_peers(found).find("flicker"), std::string::npos) << "windows of one frame";
    found["all"] = window_of(0, 0.1, 0.5, "<");
    EXPECT_NE(app::sentence_of_peers(found).find("nearer to the truth already, for 10.0 times less CPU"),
              std::string::npos);
}

TEST(BesideCycles, HoldsAFilmAgainstCyclesSlow) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const Folder folder;
    const std::string film = path(folder, "a film.blend");
    const support::Outcome made = support::blender(
        "--python-expr \"import bpy; s = "
        "bpy.context.scene; s.frame_end = 3; s.cycles.samples = 8; "
        "bpy.ops.wm.save_as_mainfile(filepath='" +
        film + "')\"");
    ASSERT_EQ(made.status, 0) << made.output;
    std::set<std::string> expected = names_in(folder);
    expected.insert({"a film.blend.export", "found.json"});
    const support::Outcome outcome =
        run(program() + " compare '" + film + "' --beside cycles --size 64x36 --sample 1x2 --quantisers 8 --json " +
            path(folder, "found.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const json found = json::parse(contents(folder / "found.json"));
    const std::string document = contents(support::source_folder() / "docs/json.md");
    for (const auto& [key, value] : found.items()) EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    ASSERT_EQ(found.at("windows").size(), 1u);
    EXPECT_EQ(found.at("windows")[0].at("first"), 0);
    EXPECT_EQ(found.at("windows")[0].at("last"), 1);
    const json &all = found.at("all"), &cycles = all.at("cycles").at("8"), &ours = all.at("ours").at("8");
    for (const auto& [key, value] : ours.items()) EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    EXPECT_GT(cycles.at("128").at("psnr_y").get<double>(), cycles.at("8").at("psnr_y").get<double>());
    EXPECT_GT(cycles.at("128").at("cpu").get<double>(), cycles.at("8").at("cpu").get<double>());
    EXPECT_GT(ours.at("psnr_y").get<double>(), 30.0);
    EXPECT_NEAR(found.at("windows")[0].at("light").at("mean").get<double>(), 1.0, 0.03);
    EXPECT_NE(outcome.output.find("Cycles, 128 samples"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find(found.at("summary").get<std::string>().substr(0, 30)), std::string::npos);
    const std::set<std::string> files = names_in(folder);
    for (const auto& [words, told] : {std::pair{"--size 48x32", "another shape"},
                                      {"--fog 5", "would not follow it"},
                                      {"--quantisers none", "nothing to compare"}}) {
        const support::Outcome refused = run(program() + " compare '" + film + "' --beside cycles " + words);
        EXPECT_EQ(refused.status, 2) << refused.output;
        EXPECT_NE(refused.output.find(told), std::string::npos) << refused.output;
    }
    EXPECT_EQ(files, expected);
    const bool denoises = found.at("denoiser") == "blender";
    EXPECT_NE(outcome.output.find(denoises ? "its OpenImageDenoise" : "a stand-in, since it has no OpenImageDenoise"),
              std::string::npos)
        << outcome.output;

    // A Blender without Cycles.
    const support::Outcome less = run(program() + " compare '" + film + "' --beside cycles --blender " +
                                      support::blender_after(folder, "import sys; sys.modules[\"_cycles\"] = None") +
                                      " --size 64x36 --sample 1x1");
    EXPECT_EQ(less.status, 1);
    EXPECT_NE(less.output.find("has no Cycles"), std::string::npos) << less.output;
}

TEST(BesideCycles, HoldsBothEyesAllAroundSlow) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const Folder folder;
    const std::string film = path(folder, "around.blend");
    const support::Outcome made =
        support::blender("-P " + (support::source_folder() / "bench/people/around.py").string() + " -- " + film);
    ASSERT_EQ(made.status, 0) << made.output;
    const support::Outcome outcome =
        run(program() + " compare " + film + " --beside cycles --size 64x32 --sample 1x2 --quantisers 8 --json " +
            path(folder, "found.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("64x32 for two eyes (top-bottom)"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("by solid angle (WS-PSNR)"), std::string::npos) << outcome.output;
    const json found = json::parse(contents(folder / "found.json"));
    EXPECT_EQ(found.at("psnr_y_by"), "solid angle");
    const json& window = found.at("windows")[0];
    EXPECT_NEAR(window.at("light").at("mean").get<double>(), 1.0, 0.03);
    EXPECT_GT(window.at("ours").at("8").at("psnr_y").get<double>(), 30.0) << "each eye lies where Cycles has it";
    EXPECT_GT(window.at("cycles").at("8").at("128").at("psnr_y").get<double>(), 30.0);
}

TEST(BesideCycles, NamesABlenderThatIsNone) {
    const Folder folder;
    std::ofstream(folder / "film.blend") << "BLENDER-v304";
    const std::string command = program() + " compare " + path(folder, "film.blend") + " --beside cycles --blender ";
    for (const auto& [name, told] : {std::pair{"/nowhere/blender", "/nowhere/blender: there is no such program"},
                                     {"blender-of-nobody", "blender-of-nobody: there is no such program"},
                                     {"/usr/bin/python3", "/usr/bin/python3: Blender's module bpy does not start"}}) {
        const support::Outcome refused = run(command + name);
        EXPECT_EQ(refused.status, 1) << refused.output;
        EXPECT_NE(refused.output.find(told), std::string::npos) << refused.output;
    }
}

}  // namespace
}  // namespace render2mpeg::test
