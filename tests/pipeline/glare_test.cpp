#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Films with glare, through the program.
namespace render2mpeg::test {
namespace {

/// A small lamp before a wall, four frames of 48x32.
std::string lamp_in(const Folder& folder, const std::string& glare) {
    std::ofstream(folder / "film.json") << R"({ "exposure": 0, "frames": 4, "size": [48, 32], )" + glare + R"(
        "camera": { "position": [0, 0, 4] }, "objects": [{ "shape": "quad", "size": [8, 5], "position": [0, 0, -2] }],
        "lights": [{ "kind": "sphere", "radius": 0.05, "intensity": 900, "position": [0.5, 0.2, 0] }] })";
    return (folder / "film.json").string();
}

std::string made(const Folder& folder, const std::string& film, const std::string& options, const std::string& name) {
    const auto result = run(program() + " render " + film + " -y --quiet --samples 1 " + options + " -o " +
                            (folder / name).string() + " --stats " + (folder / "s.json").string());
    EXPECT_EQ(result.status, 0) << result.output;
    return contents(folder / name);
}

double seconds_of_glare(const Folder& folder) {
    return nlohmann::json::parse(contents(folder / "s.json")).at("passes").value("glare", 0.0);
}

TEST(GlareInFilms, CostsNothingWhereNobodyAsksForItAndComesFromFileOrCommandLineSlow) {
    const Folder folder;
    const std::string plain = made(folder, lamp_in(folder, ""), "", "plain.m2v");
    EXPECT_EQ(seconds_of_glare(folder), 0);
    EXPECT_EQ(made(folder, lamp_in(folder, ""), "--glare static:0", "none.m2v"), plain);
    EXPECT_EQ(seconds_of_glare(folder), 0);
    const std::string of_file =
        made(folder, lamp_in(folder, R"("glare": { "kind": "static", "strength": 0.3 },)"), "", "file.m2v");
    EXPECT_GT(seconds_of_glare(folder), 0);
    EXPECT_NE(of_file, plain);
    EXPECT_EQ(made(folder, lamp_in(folder, ""), "--glare static:0.3", "line.m2v"), of_file);
    EXPECT_EQ(made(folder, lamp_in(folder, R"("glare": "temporal",)"), "--glare off", "off.m2v"), plain);
}

TEST(GlareInFilms, IsShownWhereItIsAskedForAndSaysThatTheFileWouldHaveNoneSlow) {
    const Folder folder;
    const std::string asked = made(folder, lamp_in(folder, ""), "--glare static", "asked.m2v");
    const std::string none = lamp_in(folder, R"("glare": { "kind": "static", "strength": 0 },)");
    EXPECT_EQ(made(folder, none, "--glare static", "none.m2v"), asked);
    EXPECT_EQ(made(folder, none, "--glare static:0", "zero.m2v"), made(folder, none, "", "plain.m2v"));
    const auto plan = run(program() + " plan " + none + " --glare static");
    EXPECT_NE(plan.output.find("--glare static: the file's glare has strength 0; it is 0.1 now"), std::string::npos)
        << plan.output;
    EXPECT_EQ(run(program() + " plan " + none).output.find("strength 0"), std::string::npos);
}

TEST(GlareInFilms, TakesFewerRaysUnderTheVeilSlow) {
    const Folder folder;
    std::ofstream(folder / "film.json") << R"({ "size": [64, 48], "frames": 3, "exposure": 3,
        "camera": { "position": [0, 1.7, 9], "look_at": [0, 1.4, 0] }, "objects": [{ "shape": "plane", "size": [40, 40] },
            { "shape": "cylinder", "radius": 0.2, "height": 4, "position": [0, 0, -1.2], "segments": 16,
              "repeat": { "count": [7, 1, 3], "step": [1.15, 0, 1.7], "centered": true } }],
        "lights": [{ "kind": "sphere", "radius": 0.1, "intensity": 14, "position": [0, 1.5, 2] },
            { "kind": "point", "intensity": 14, "position": [0, 2.2, -3],
              "repeat": { "count": [4, 1, 4], "step": [3.1, 0, 4.3], "centered": true } }] })";
    const auto shadow_rays = [&](const std::string& glare) {
        const auto result =
            run(program() + " render " + (folder / "film.json").string() + " -y --quiet --glare " + glare + " -o " +
                (folder / "film.m2v").string() + " --stats " + (folder / "s.json").string());
        EXPECT_EQ(result.status, 0) << result.output;
        return nlohmann::json::parse(contents(folder / "s.json")).at("counts").at("shadow_rays").get<double>();
    };
    // 5 % fewer if tolerances of what is shown were the light's.
    EXPECT_LT(shadow_rays("static:0.3"), 0.9 * shadow_rays("off"));
}

TEST(GlareInFilms, HasTheSameBytesForAnyThreadsAndChunksSlow) {
    const Folder folder;
    const std::string film = lamp_in(folder, R"("glare": "temporal",)");
    const std::string one = made(folder, film, "--gop 1 --threads 1", "one.m2v");
    EXPECT_EQ(made(folder, film, "--gop 1 --threads 2", "two.m2v"), one);
    // The last frames by themselves are what they are in the whole film: glare knows not what was before.
    made(folder, film, "--frames 3:3", "last.%04d.png");
    made(folder, film, "", "all.%04d.png");
    EXPECT_EQ(contents(folder / "last.0003.png"), contents(folder / "all.0003.png"));
    EXPECT_FALSE(contents(folder / "all.0003.png").empty());
}

TEST(GlareInFilms, IsNotInLayersAndOpenExr) {
    const Folder folder;
    made(folder, lamp_in(folder, ""), "", "plain.%04d.exr");
    made(folder, lamp_in(folder, R"("glare": "static",)"), "", "glare.%04d.exr");
    EXPECT_EQ(contents(folder / "plain.0002.exr"), contents(folder / "glare.0002.exr"));
    EXPECT_FALSE(contents(folder / "plain.0002.exr").empty());
}

}  // namespace
}  // namespace render2mpeg::test
