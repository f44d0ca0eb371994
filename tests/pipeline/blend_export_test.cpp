// What the export of a .blend holds (tests/blender/make_exports.py makes them).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "pipeline/fixture.h"

namespace render2mpeg::test {
namespace {

using nlohmann::json;
using support::Outcome;

using support::blender_script;

/// The workshop's export, made once.
class BlendExportTogetherSlow : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        if (!support::blender_is_there()) return;
        folder_ = std::make_unique<Folder>();
        ASSERT_EQ(
            support::blender("-P " + blender_script("make_exports.py") + " -- " + folder_->path().string()).status, 0);
        const Outcome said = run(program() + " plan --within 0 " + path(*folder_, "workshop.blend"));
        ASSERT_EQ(said.status, 0) << said.output;
        said_ = said.output;
        for (const auto& entry : std::filesystem::directory_iterator(path(*folder_, "workshop.blend.export")))
            export_ = entry.path();
        const std::string glb = contents(export_ / "scene.glb");
        std::uint32_t length = 0;
        std::memcpy(&length, glb.data() + 12, 4);
        scene_ = json::parse(glb.substr(20, length));
        film_ = json::parse(contents(export_ / "film.json"));
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override {
        if (!folder_) GTEST_SKIP() << "Blender is not installed";
    }

    static json material(const std::string& name) {
        for (const json& m : scene_["materials"])
            if (m["name"] == name) return m;
        return {};
    }
    static json mesh_of(const std::string& node) {
        for (const json& n : scene_["nodes"])
            if (n["name"] == node) return scene_["meshes"][n["mesh"].get<std::size_t>()]["primitives"][0];
        return {};
    }
    /// Side of the texture of a material's colour; 0 where it has none.
    static std::uint32_t texture_side(const std::string& name) {
        const json says = material(name)["pbrMetallicRoughness"];
        if (!says.contains("baseColorTexture")) return 0;
        const json texture = scene_["textures"][says["baseColorTexture"]["index"].get<std::size_t>()];
        const std::string uri = scene_["images"][texture["source"].get<std::size_t>()]["uri"];
        const std::string png = contents(export_ / uri);
        std::uint32_t side = 0;
        for (std::size_t i = 16; i < 20; ++i) side = side << 8 | static_cast<unsigned char>(png.at(i));
        return side;
    }

    static inline std::unique_ptr<Folder> folder_;
    static inline std::filesystem::path export_;
    static inline std::string said_;
    static inline json scene_, film_;
};

TEST_F(BlendExportTogetherSlow, EndsShortenedStrandsWhereTheyEnd) {
    const json strands = mesh_of("Skin Fur");
    ASSERT_EQ(strands["mode"], 1);
    const json places = scene_["accessors"][strands["attributes"]["POSITION"].get<std::size_t>()];
    // Hair of 0.5 on a ball of radius 1, which stands far from the world's origin.
    double farthest = 0;
    for (const char* end : {"min", "max"})
        for (const json& c : places[end]) farthest = std::max(farthest, std::abs(c.get<double>()));
    EXPECT_GT(farthest, 1.1);
    EXPECT_LT(farthest, 1.6);
}

TEST_F(BlendExportTogetherSlow, BakesTexturesOfCurves) {
    EXPECT_EQ(said_.find("cannot be baked"), std::string::npos) << said_;
    EXPECT_GE(texture_side("Bark"), 64u);
    EXPECT_TRUE(mesh_of("Branch")["attributes"].contains("TEXCOORD_0"));
}

TEST_F(BlendExportTogetherSlow, SharesTexturesOfEqualMeshesAndBakesThemAsLargeAsTheyAreSeen) {
    std::set<json> materials;
    for (const char* box : {"Box 0", "Box 1", "Box 2"}) materials.insert(mesh_of(box)["material"]);
    EXPECT_EQ(materials.size(), 1u);
    // A texel for each of the pixels: at 2.5 m more than 64 of 160x90, at 60 m fewer.
    EXPECT_EQ(texture_side("Far Tiles"), 64u);
    EXPECT_GT(texture_side("Tiles"), 64u);
    EXPECT_LE(texture_side("Tiles"), 1024u);
}

TEST_F(BlendExportTogetherSlow, MakesAConstantOfWhatIsTheSameAllOver) {
    const json says = material("Even")["pbrMetallicRoughness"];
    EXPECT_FALSE(says.contains("baseColorTexture"));
    const double wanted[] = {0.3, 0.3, 0.4};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(says["baseColorFactor"][i].get<double>(), wanted[i], 1e-3);
}

TEST_F(BlendExportTogetherSlow, HasOneMaterialForMeshesOnWhichItsTexturesCameOutAlike) {
    std::set<json> worn, rough;
    for (const char* kind : {" cube", " cone", " plane"}) {
        worn.insert(mesh_of(std::string("Worn") + kind)["material"]);
        rough.insert(mesh_of(std::string("Rough") + kind)["material"]);
    }
    EXPECT_EQ(worn.size(), 1u) << "a bump of no strength is the same on each";
    EXPECT_FALSE(material("Worn").contains("normalTexture"));
    EXPECT_EQ(rough.size(), 3u) << "noise in space differs";
    EXPECT_TRUE(material("Rough").contains("normalTexture"));
    std::size_t images = 0;
    for (const json& image : scene_["images"]) images += image["uri"].get<std::string>().starts_with("Worn") ? 1 : 0;
    EXPECT_EQ(images, 0u);
}

TEST_F(BlendExportTogetherSlow, HasSpotsWithTheFalloffOfTheirBlender) {
    const json spot = film_["lights"][0];
    EXPECT_EQ(spot["kind"], "spot");
    EXPECT_NEAR(spot["intensity"].get<double>(), 100, 1e-3);
    EXPECT_NEAR(spot["angle"].get<double>(), 120, 1e-3);
}

TEST_F(BlendExportTogetherSlow, FollowsInstancesAndWhatTakesAnothersPlace) {
    std::size_t birds = 0, moving = 0;
    for (std::size_t i = 0; i < scene_["nodes"].size(); ++i) {
        if (scene_["nodes"][i]["name"].get<std::string>().find("/Bird") == std::string::npos) continue;
        ++birds;
        for (const json& channel : scene_["animations"][0]["channels"])
            moving += channel["target"]["node"] == i && channel["target"]["path"] == "translation";
    }
    EXPECT_EQ(birds, 10u);
    EXPECT_EQ(moving, 5u);
    const json change = film_["change"];
    EXPECT_EQ(change["First"]["keys"][0]["visible"], true);
    EXPECT_EQ(change["First"]["keys"][1]["visible"], false);
    EXPECT_EQ(change["Second"]["keys"][0]["visible"], false);
    EXPECT_EQ(change["Second"]["keys"][1]["visible"], true);
}

TEST_F(BlendExportTogetherSlow, LightsTheGroundBelowAWideSpotAsCyclesDoes) {
    const std::string blend = path(*folder_, "wide_spot.blend"), at = folder_->path().string();
    ASSERT_EQ(run(program() + " render -y --hold " + blend + " -o " + path(*folder_, "ours%04d.exr") +
                  " --frames 0:0 --exposure 0 --quiet")
                  .status,
              0);
    const Outcome compared =
        support::blender(blend + " -P " + blender_script("cycles.py") + " -P " + blender_script("compare.py") + " -- " +
                         at + " 0 --samples 16 --patches 6x4");
    ASSERT_EQ(compared.status, 0) << compared.output;
    std::istringstream lines(compared.output);
    int patches = 0;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string begin;
        if (!(words >> begin) || begin != "PATCH") continue;
        double number = 0, ratio = 0;
        words >> number >> ratio;
        EXPECT_NEAR(ratio, 1, 0.01) << line;
        ++patches;
    }
    EXPECT_EQ(patches, 24) << compared.output;
}

TEST(BlendExportSlow, EndsWhereTheFilmThatIsAskedForEnds) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const Folder folder;
    const Outcome made =
        support::blender("-P " + blender_script("make_blends.py") + " -- " + folder.path().string() + " instances");
    ASSERT_EQ(made.status, 0) << made.output;
    const std::filesystem::path blend = folder / "instances.blend", film = folder / "film.mpg";
    const auto bytes_of = [&](const std::string& frames) {
        const Outcome said = run(program() + " render --size 64x36 --quiet --frames " + frames + " " + blend.string() +
                                 " -o " + film.string());
        EXPECT_EQ(said.status, 0) << said.output;
        std::string bytes = contents(film);
        std::filesystem::remove(film);
        return bytes;
    };
    const std::string part = bytes_of("0:1");
    const json early =
        json::parse(contents(std::filesystem::directory_iterator(blend.string() + ".export")->path() / "film.json"));
    EXPECT_EQ(early["frames"], 8) << "it is as long as ever";
    EXPECT_EQ(early.value("change", json::object()).value("Late", json::object()).value("keys", json::array()).size(),
              0u)
        << "it comes at the fifth frame";
    EXPECT_NE(bytes_of("4:5"), part);
    std::filesystem::remove_all(blend.string() + ".export");
    bytes_of("0:7");
    EXPECT_EQ(bytes_of("0:1"), part);
    EXPECT_EQ(run(program() + " plan --within 0 " + blend.string()).status, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(blend.string() + ".export"),
                            std::filesystem::directory_iterator{}),
              2)
        << "that of all frames at this size, which serves its parts, and that at its own";
}

}  // namespace
}  // namespace render2mpeg::test
