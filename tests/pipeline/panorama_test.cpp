#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Panoramas through the program: said by the command line and by animation files.
namespace render2mpeg::test {
namespace {

const std::string room =
    R"("frames": 2, "exposure": 0, "sky": 1, "objects": [{ "shape": "box", "position": [2, 0, 0] }])";

std::string panorama(const Folder& folder, const std::string& camera, const std::string& more = "") {
    std::ofstream(folder / "film.json") << "{ " << room << more << R"(, "camera": )" << camera << " }";
    return path(folder, "film.json");
}

support::Outcome plan(const std::string& words) {
    return run(program() + " plan --within 0 " + words);
}

TEST(PanoramaFilm, IsPlannedTwoByOneOrSquareAndSaysWhatItShows) {
    const Folder folder;
    const std::string plain = panorama(folder, R"({ "position": [0, 0, 3] })");
    const auto all = plan(plain + " --projection equirectangular");
    EXPECT_EQ(all.status, 0) << all.output;
    EXPECT_NE(all.output.find("640x320"), std::string::npos) << all.output;
    EXPECT_NE(all.output.find("a panorama of 360 by 180 degrees"), std::string::npos) << all.output;
    EXPECT_EQ(all.output.find("stretched"), std::string::npos) << all.output;
    const auto half = plan(plain + " --projection vr180");
    EXPECT_NE(half.output.find("640x640"), std::string::npos) << half.output;
    EXPECT_NE(half.output.find("a panorama of 180 by 180 degrees"), std::string::npos) << half.output;
    const auto wide = plan(plain + " --projection equirectangular --size 640x360");
    EXPECT_EQ(wide.status, 0);
    EXPECT_NE(wide.output.find("640x360: a panorama of 360 by 180 degrees is 2 times as wide as high; it is stretched"),
              std::string::npos)
        << wide.output;
}

TEST(PanoramaFilm, OfAnAnimationFileShowsItsWindow) {
    const Folder folder;
    const auto some = plan(panorama(
        folder,
        R"({ "projection": "equirectangular", "longitudes": [-60, 60], "latitudes": [-30, 30], "near": 0.1 })"));
    EXPECT_EQ(some.status, 0) << some.output;
    EXPECT_NE(some.output.find("a panorama of 120 by 60 degrees"), std::string::npos) << some.output;
    EXPECT_NE(some.output.find("640x320"), std::string::npos) << some.output;
}

TEST(PanoramaFilm, HasNoLensAndTellsSo) {
    const Folder folder;
    const std::string blurred = panorama(folder, R"({ "position": [0, 0, 3], "f_stop": 2, "focus": 3 })");
    const auto told = plan(blurred + " --projection equirectangular");
    EXPECT_EQ(told.status, 0);
    EXPECT_NE(told.output.find("a panorama has no lens, all of it is sharp"), std::string::npos) << told.output;
    const std::string parallel = panorama(folder, R"({ "position": [0, 0, 3], "height": 2 })");
    const auto refused = plan(parallel + " --projection equirectangular");
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.output.find("parallel rays"), std::string::npos) << refused.output;
}

TEST(PanoramaFilm, IsMadeWithAllThatMovesAndBlurs) {
    const Folder folder;
    const std::string turning = panorama(
        folder,
        R"({ "projection": "equirectangular", "keys": [{ "at": 0, "rotate": 0 }, { "at": 0.08, "rotate": 20 }] })",
        R"(, "shutter": 180, "fog": { "visibility": 50 })");
    const auto made =
        run(program() + " render " + turning + " --size 64x32 --samples 1 --quiet -o " + path(folder, "film.mpg"));
    EXPECT_EQ(made.status, 0) << made.output;
    EXPECT_EQ(made.output, "");
}

TEST(PanoramaFilm, SaysThatItIsOneWhereItsFileCan) {
    const Folder folder;
    const std::string half = panorama(folder, R"({ "projection": "vr180" })");
    const std::string words = " render " + half + " --size 64x64 --samples 1 --frames 0:0 --overwrite -o ";
    ASSERT_EQ(run(program() + words + path(folder, "film.mp4") + " --quiet").status, 0);
    const auto shown = run(program() + " info --summary " + path(folder, "film.mp4"));
    EXPECT_NE(shown.output.find("equirectangular, 180 by 180 degrees"), std::string::npos) << shown.output;
    const auto json = run(program() + " info --json " + path(folder, "film.mp4"));
    EXPECT_NE(json.output.find("\"panorama\""), std::string::npos);
    const auto told = run(program() + words + path(folder, "film.mpg"));
    EXPECT_EQ(told.status, 0);
    EXPECT_NE(told.output.find("such files cannot say that they are panoramas; .mp4, .mkv and .webm do"),
              std::string::npos)
        << told.output;
}

/// The planned and the mean quantiser of a film's pictures.
std::pair<double, double> quantisers_of(const Folder& folder, const std::string& film, const std::string& words) {
    EXPECT_EQ(
        run(program() + " render " + film + " --size 256x128 --samples 1 --frames 0:1 --quiet --overwrite --stats " +
            path(folder, "stats.json") + " " + words)
            .status,
        0);
    std::pair<double, double> sum;
    const json stats = json::parse(contents(folder / "stats.json"));
    for (const json& frame : stats.at("per_frame")) {
        sum.first += frame.at("quantiser").get<double>();
        sum.second += frame.at("mean_quantiser").get<double>();
    }
    return sum;
}

TEST(PanoramaFilm, IsCodedMoreCoarselyTowardsItsPoles) {
    const Folder folder;
    const std::string around = panorama(folder, R"({ "projection": "equirectangular" })");
    // The mean over latitudes of 1 / sqrt(cos) is 1.67, of its logarithm to base 2 0.5 times 1.
    for (const auto& [words, most] :
         {std::pair<std::string, double>{"--tune psnr --codec h264 -o " + path(folder, "a.mkv"), 6},
          {"--tune psnr --codec hevc -o " + path(folder, "b.mkv"), 6}}) {
        const auto [planned, mean] = quantisers_of(folder, around, words);
        EXPECT_NEAR((mean - planned) / 2, 0.5 * most, 1.3) << words;
    }
    const auto [planned, mean] = quantisers_of(folder, around, "--quantiser 8 -o " + path(folder, "c.mpg"));
    EXPECT_NEAR(mean / planned, 1.4, 0.25);
}

}  // namespace
}  // namespace render2mpeg::test
