#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Films in fog, through the program.
namespace render2mpeg::test {
namespace {

/// A lamp and a post before a wall, four frames of 48x32.
std::string post_in(const Folder& folder, const std::string& keys, const std::string& lamp = "[0.5, 0.2, 0]") {
    std::ofstream(folder / "film.json") << R"({ "exposure": 0, "frames": 4, "size": [48, 32], )" + keys + R"(
        "camera": { "position": [0, 0, 4] },
        "objects": [{ "shape": "quad", "size": [8, 5], "position": [0, 0, -2] },
                    { "shape": "box", "size": [0.3, 2, 0.3], "position": [0.6, -1, -0.8] }],
        "lights": [{ "kind": "point", "intensity": 9, "position": )" +
                                               lamp + "}] }";
    return (folder / "film.json").string();
}

nlohmann::json statistics_in(const Folder& folder) {
    return nlohmann::json::parse(contents(folder / "s.json"));
}

std::string fog_film(const Folder& folder, const std::string& film, const std::string& options,
                     const std::string& name) {
    const auto result = run(program() + " render " + film + " -y --quiet --samples 1 " + options + " -o " +
                            (folder / name).string() + " --stats " + (folder / "s.json").string());
    EXPECT_EQ(result.status, 0) << result.output;
    if (result.status == 0) {
        EXPECT_EQ(statistics_in(folder).at("counts").at("non_finite"), 0) << options;
    }
    return contents(folder / name);
}

TEST(FogInFilms, CostsNothingWhereThereIsNoneAndComesFromFileOrCommandLineSlow) {
    const Folder folder;
    const std::string plain = fog_film(folder, post_in(folder, ""), "", "plain.m2v");
    const nlohmann::json clear = statistics_in(folder);
    EXPECT_EQ(fog_film(folder, post_in(folder, R"("fog": "off",)"), "", "none.m2v"), plain);
    EXPECT_EQ(statistics_in(folder).at("counts").at("shadow_rays"), clear.at("counts").at("shadow_rays"));
    EXPECT_EQ(clear.at("counts").at("air_rays"), 0);
    const std::string of_file = fog_film(folder, post_in(folder, R"("fog": { "visibility": 12 },)"), "", "file.m2v");
    EXPECT_GT(statistics_in(folder).at("counts").at("air_rays"), 0);
    EXPECT_NE(of_file, plain);
    EXPECT_EQ(fog_film(folder, post_in(folder, ""), "--fog 12", "line.m2v"), of_file);
    EXPECT_EQ(fog_film(folder, post_in(folder, R"("fog": 12,)"), "--fog off", "off.m2v"), plain);
}

TEST(FogInFilms, HasTheSameBytesForAnyThreadsAndChunksSlow) {
    const Folder folder;
    const std::string film = post_in(folder, R"("fog": { "visibility": 12, "falloff": 2, "anisotropy": 0.4 },)");
    const std::string one = fog_film(folder, film, "--gop 1 --threads 1", "one.m2v");
    EXPECT_EQ(fog_film(folder, film, "--gop 1 --threads 2", "two.m2v"), one);
    fog_film(folder, film, "--frames 3:3", "last.%04d.png");
    fog_film(folder, film, "", "all.%04d.png");
    EXPECT_EQ(contents(folder / "last.0003.png"), contents(folder / "all.0003.png"));
    EXPECT_FALSE(contents(folder / "all.0003.png").empty());
}

TEST(FogInFilms, IsFiniteHoweverDenseWhereverLampsAreSlow) {
    const Folder folder;
    for (const std::string fog : {"0.0001", "1", "1e9", R"({ "visibility": 5, "color": 0 })",
                                  R"({ "visibility": 5, "falloff": 0.01, "height": 100 })",
                                  R"({ "visibility": 5, "falloff": 0.01, "height": -100 })"})
        for (const std::string lamp : {"[0, 0, 4]", "[0.6, 0, -0.8]", "[0, 0, -50]"})
            fog_film(folder, post_in(folder, "\"fog\": " + fog + ",", lamp), "--frames 0:0", "x.m2v");
    std::ofstream(folder / "film.json") << R"({ "frames": 1, "size": [64, 48], "fog": 10, "sky": 0.5 })";
    fog_film(folder, (folder / "film.json").string(), "", "nothing.m2v");
}

TEST(FogInFilms, ShowsBlackWhereItIsBlackAndDenseSlow) {
    const Folder folder;
    fog_film(folder, post_in(folder, R"("fog": { "visibility": 0.001, "color": 0 },)"), "--frames 0:0", "b.%04d.png");
    fog_film(folder, post_in(folder, R"("fog": { "visibility": 0.001, "color": 0 },)"), "--frames 1:1", "b.%04d.png");
    EXPECT_EQ(contents(folder / "b.0000.png"), contents(folder / "b.0001.png"));
}

}  // namespace
}  // namespace render2mpeg::test
