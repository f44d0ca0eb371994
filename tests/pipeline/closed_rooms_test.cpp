#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"

/// Light of rooms without an opening, as a render makes it without being asked: each bounce's error adds up there.
namespace render2mpeg::app {
namespace {

struct Wall {
    const char* name;
    const char* material;
    double bound;  ///< of the mean, as a share
};

class ClosedRoomsSlow : public testing::TestWithParam<Wall> {};

std::string room_of(const std::string& material) {
    std::string text = R"({"size": [64, 64], "seconds": 0.2,
        "camera": {"position": [0, 1, 0.95], "look_at": [0, 0.9, -1], "fov": 70},
        "lights": [{"kind": "point", "position": [0.3, 1.6, 0.2], "color": 1, "intensity": 3}],
        "objects": [)";
    for (const char* wall :
         {R"("shape": "plane")", R"("shape": "plane", "position": [0, 2, 0], "rotate": [180, 0, 0])",
          R"("shape": "quad", "position": [0, 1, -1])", R"("shape": "quad", "position": [0, 1, 1], "rotate": 180)",
          R"("shape": "quad", "position": [-1, 1, 0], "rotate": 90)",
          R"("shape": "quad", "position": [1, 1, 0], "rotate": -90)"})
        text += "{" + std::string(wall) + R"(, "size": [2, 2], "material": "wall"},)";
    text += R"({"shape": "box", "size": 0.6, "position": [0.2, 0, -0.4], "rotate": 20, "material": "wall"}],)";
    return text + R"("materials": {"wall": )" + material + "}}";
}

TEST_P(ClosedRoomsSlow, AreAsBrightAsByPaths) {
    const support::Folder folder;
    std::ofstream(folder / "room.json") << room_of(GetParam().material);
    const std::string stats = (folder / "s.json").string();
    const support::Outcome outcome = support::run(
        support::program() + " render -y --hold " + (folder / "room.json").string() +
        " --frames 0:1 --size 40x40 -q 8 --audit 32 -o " + (folder / "a.m2v").string() + " --stats " + stats);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const nlohmann::json bias =
        nlohmann::json::parse(support::contents(stats)).at("audit").at("truth").at("total").at("bias");
    const double error = bias.at("error").get<double>();
    EXPECT_LT(error, 0.015);
    EXPECT_NEAR(bias.at("value").get<double>(), 0.0, GetParam().bound + 2.0 * error);
}

INSTANTIATE_TEST_SUITE_P(Of, ClosedRoomsSlow,
                         testing::Values(Wall{"RoughPaint", R"({"base_color": 0.8, "roughness": 0.9})", 0.01},
                                         Wall{"WhitePaint", R"({"base_color": 0.95, "roughness": 1})", 0.01},
                                         Wall{"RoughMetal", R"({"base_color": 0.9, "roughness": 0.6, "metallic": 1})",
                                              0.04}),
                         [](const testing::TestParamInfo<Wall>& info) { return info.param.name; });

}  // namespace
}  // namespace render2mpeg::app
