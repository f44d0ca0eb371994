#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/fixture.h"

/// Films and stills with Blender's views, through the program.
namespace render2mpeg::test {
namespace {

const std::string tiny_view = " --size 64x48 --samples 1 --exposure 0 --tolerance fixed=10% --quiet --frames 0:1 ";

/// Mean size of what differs of two pictures' RGB code values.
double mean_difference(const std::string& one, const std::string& two) {
    const std::string a = test::codes_of(one), b = test::codes_of(two);
    EXPECT_EQ(a.size(), std::size_t{64} * 48 * 3);
    if (a.size() != b.size() || a.empty()) return 255;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::abs(static_cast<unsigned char>(a[i]) - static_cast<unsigned char>(b[i]));
    return sum / static_cast<double>(a.size());
}

TEST(View, FilmsShowBlendersCodeValuesAndSayWhichViewTheyHaveSlow) {
    const Folder folder;
    const std::string render = program() + " render " + support::plain_film() + tiny_view;
    ASSERT_EQ(
        run(render + " --view filmic --quantiser 1 -o " + path(folder, "f.m2v") + " --stats " + path(folder, "s.json"))
            .status,
        0);
    EXPECT_EQ(nlohmann::json::parse(contents(folder / "s.json")).at("view"), "filmic");
    ASSERT_EQ(run(render + " --view filmic -o " + path(folder, "p.%04d.png")).status, 0);
    ASSERT_EQ(run(render + " --view standard -o " + path(folder, "q.%04d.png")).status, 0);
    const double same = mean_difference(path(folder, "f.m2v"), path(folder, "p.0000.png")),
                 other = mean_difference(path(folder, "f.m2v"), path(folder, "q.0000.png"));
    EXPECT_LT(same, 4) << "halved chroma of small, sharp things";
    EXPECT_GT(other, 2 * same);
    // No number of MPEG-2's stands for sRGB's curve; BT.709's is the nearest, and players that know none guess worse.
    const std::string probe = "ffprobe -v error -show_entries stream=color_transfer -of csv=p=0 ";
    EXPECT_NE(run(probe + path(folder, "f.m2v")).output.find("bt709"), std::string::npos);

    // Still images of a view become the film that the view would have given.
    ASSERT_EQ(run(program() + " encode " + path(folder, "p.%04d.png") + " --view filmic --quantiser 1 --quiet -o " +
                  path(folder, "g.m2v"))
                  .status,
              0);
    EXPECT_LT(mean_difference(path(folder, "g.m2v"), path(folder, "p.0000.png")), 4);
    const auto refused =
        run(program() + " encode " + path(folder, "no.y4m") + " --view agx -o " + path(folder, "h.m2v"));
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.output.find("view"), std::string::npos) << refused.output;
}

TEST(View, OfAnAnimationFileIsKeptUnlessTheCommandLineSaysAnotherSlow) {
    const Folder folder;
    std::ofstream(folder / "film.json") << R"({ "view": { "name": "agx", "gamma": 1.5 }, "exposure": 0, "frames": 1,
        "camera": { "position": [0, 0, 3] }, "sky": 1, "objects": [{ "shape": "box" }] })";
    const std::string plan = program() + " plan " + path(folder, "film.json");
    EXPECT_NE(run(plan).output.find("view agx, gamma 1.5"), std::string::npos);
    EXPECT_NE(run(plan + " --view filmic-low-contrast").output.find("view filmic-low-contrast\n"), std::string::npos);
    EXPECT_EQ(run(plan + " --view neutral").output.find("; view"), std::string::npos);
    const auto wrong = run(plan + " --view purple");
    EXPECT_NE(wrong.status, 0);
    EXPECT_NE(wrong.output.find("filmic-very-high-contrast"), std::string::npos) << wrong.output;
}

}  // namespace
}  // namespace render2mpeg::test
