// Volumes of a .blend (tests/blender/make_volumes.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <set>
#include <string>

#include "pipeline/fixture.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/volumes/volume_reader.h"

namespace render2mpeg::test {
namespace {

using nlohmann::json;
using support::Outcome;

class BlendVolumesTogetherSlow : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        if (!support::blender_is_there()) return;
        folder_ = std::make_unique<Folder>();
        const Outcome made =
            support::blender("-P " + support::blender_script("make_volumes.py") + " -- " + folder_->path().string());
        ASSERT_EQ(made.status, 0) << made.output;
        const Outcome said = run(program() + " plan --within 0 " + path(*folder_, "volumes.blend"));
        ASSERT_EQ(said.status, 0) << said.output;
        said_ = said.output;
        for (const auto& entry : std::filesystem::directory_iterator(path(*folder_, "volumes.blend.export")))
            export_ = entry.path();
        film_ = json::parse(contents(export_ / "film.json"));
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override {
        if (!folder_) GTEST_SKIP() << "Blender is not installed";
    }

    static json volume(const std::string& name) {
        for (const json& v : film_["volumes"])
            if (v["name"] == name) return v;
        return {};
    }
    static std::size_t index_of(const scene::Animation& film, const std::string& name) {
        for (std::size_t i = 0; i < film.volumes.size(); ++i)
            if (film.volumes[i].name == name) return i;
        ADD_FAILURE() << "no volume " << name;
        return 0;
    }

    static inline std::unique_ptr<Folder> folder_;
    static inline std::filesystem::path export_;
    static inline std::string said_;
    static inline json film_;
};

TEST_F(BlendVolumesTogetherSlow, AreToldWhereTheyAreNotKept) {
    EXPECT_EQ(film_["volumes"].size(), 6u);
    EXPECT_NE(said_.find("6 volumes"), std::string::npos) << said_;
    for (const char* line :
         {"not kept: Open: a volume in a shape that is open; it is not there in the film",
          "not kept: Scene: 0 volume bounces; the film has light that volumes scatter more often, too",
          "not kept: Tinted: material Tinted, node Noise Texture: gives colours that differ from place to place; the "
          "volume is not there in the film"})
        EXPECT_NE(said_.find(line), std::string::npos) << line << " is not in\n" << said_;
    for (const char* name : {"Even", "Ball", "Ramp", "Noise"})
        EXPECT_EQ(said_.find(std::string("not kept: ") + name), std::string::npos) << name << " in\n" << said_;
}

TEST_F(BlendVolumesTogetherSlow, FillShapesThatAreNoBoxes) {
    const scene::Animation film = scene::load(export_ / "film.json");
    std::vector<std::string> notes;
    const auto grids = scene::read_volume(film.volumes[index_of(film, "Ball")], 0, notes);
    double sum = 0;
    grids->density.each(
        [&](glm::ivec3, const auto& brick) { sum += std::accumulate(brick.begin(), brick.end(), 0.0); });
    // Blender's ball: 16 bands between polygons of 32 corners, whose area at latitude t is 16 sin(pi / 16) cos^2(t).
    double volume = 0;
    const double ring = 16 * std::sin(std::numbers::pi / 16);
    for (int k = 0; k < 16; ++k) {
        const double a = std::numbers::pi * (k / 16.0 - 0.5), b = std::numbers::pi * ((k + 1) / 16.0 - 0.5);
        const double low = std::cos(a), high = std::cos(b);
        volume += ring * (std::sin(b) - std::sin(a)) * (low * low + low * high + high * high) / 3;
    }
    EXPECT_NEAR(sum * std::abs(glm::determinant(glm::dmat3(grids->object_from_index))) / volume, 1, 0.003);
}

TEST_F(BlendVolumesTogetherSlow, HaveDensitiesThatNodesSay) {
    const scene::Animation film = scene::load(export_ / "film.json");
    ASSERT_EQ(volume("Ramp")["file"].size(), 6u);
    const std::size_t index = index_of(film, "Ramp");
    std::vector<std::string> notes;
    for (const int frame : {0, 5}) {
        const auto world = scene::snapshot_at(film, frame, {frame, 24}, {16, 16, 1});
        const auto grids =
            scene::read_volume(film.volumes[index], static_cast<std::size_t>(world.volumes[index].file), notes);
        const glm::dmat4 to_world = world.volumes[index].world_from_object * grids->object_from_index;
        int voxels = 0;
        grids->density.each([&](glm::ivec3 place, const auto& brick) {
            for (int k = 0; k < core::SparseGrid<float>::brick_voxels; ++k) {
                const float value = brick[static_cast<std::size_t>(k)];
                if (value == 0) continue;
                const glm::dvec4 voxel(core::SparseGrid<float>::voxel(place, k), 1);
                const double x = (to_world * voxel).x + film.origin.x;
                // The four samples of a texel are anywhere within it.
                EXPECT_NEAR(value, std::clamp(2 * (x - 7.5), 0.0, 2.0), 0.06) << frame << " at " << x;
                ++voxels;
            }
        });
        EXPECT_GE(voxels, 15 * 15 * 15) << frame;
    }
    const json moving = volume("Noise")["file"];
    EXPECT_EQ(std::set<json>(moving.begin(), moving.end()).size(), 6u);
    const auto first = contents(export_ / std::string(moving[0])), last = contents(export_ / std::string(moving[5]));
    EXPECT_NE(first, last);
}

TEST_F(BlendVolumesTogetherSlow, HaveTheWorldsUnitsInMeshesAndTheirOwnInVolumes) {
    // A cube of twice its size has the optical depth of two units.
    EXPECT_NEAR(volume("Even")["density"], 1, 1e-6);
    EXPECT_NEAR(volume("Even")["color"][1], 0.7, 1e-6);
    EXPECT_EQ(volume("Even")["anisotropy"], 0.25);
    EXPECT_EQ(volume("Cloud")["density"], 3);
    EXPECT_EQ(volume("Domain")["blackbody"], 1);
    // Noise makes density finer; heat is in the coarse files.
    EXPECT_EQ(volume("Domain")["density_grid"], "density_noise");
    EXPECT_EQ(volume("Domain")["temperature_grid"], "temperature");
    EXPECT_EQ(volume("Domain")["file"].size(), volume("Domain")["more"].size());
    EXPECT_FALSE(volume("Cloud").contains("blackbody"));
}

TEST_F(BlendVolumesTogetherSlow, ShowTheirFilesFrameByFrame) {
    // The sequence begins a frame after the film, and ends a frame before it.
    const json cloud = volume("Cloud");
    ASSERT_EQ(cloud["file"].size(), 6u);
    EXPECT_EQ(cloud["file"][0], cloud["file"][1]);
    EXPECT_NE(cloud["file"][1], cloud["file"][2]);
    const scene::Animation film = scene::load(export_ / "film.json");
    const std::size_t index = index_of(film, "Cloud");
    for (int frame = 0; frame < 6; ++frame) {
        const auto world = scene::snapshot_at(film, frame, {frame, 24}, {16, 16, 1});
        EXPECT_EQ(world.volumes.at(index).present, frame >= 1 && frame <= 4) << frame;
        EXPECT_EQ(world.volumes.at(index).file, static_cast<std::size_t>(frame));
    }
}

TEST_F(BlendVolumesTogetherSlow, StandWhereBlenderHasThem) {
    const scene::Animation film = scene::load(export_ / "film.json");
    const auto world = scene::snapshot_at(film, 5, {5, 24}, {16, 16, 1});
    const auto box = [&](const char* name) {
        const std::size_t index = index_of(film, name);
        return film.volumes[index].outline.box.moved(world.volumes[index].world_from_object);
    };
    // Blender's z is up; the domain is centred at (1, 2, 1.5) and 2.5 x 2.5 x 4.5 large.
    const scene::VolumeBox even = box("Even"), smoke = box("Domain");
    const glm::dvec3 origin = film.origin;
    EXPECT_LT(glm::distance(even.low + origin, glm::dvec3(3, 0, -1)), 1e-5);
    EXPECT_LT(glm::distance(even.high + origin, glm::dvec3(5, 2, 1)), 1e-5);
    const glm::dvec3 low = glm::dvec3(-0.25, -0.75, -3.25), high = glm::dvec3(2.25, 3.75, -0.75);
    EXPECT_TRUE(glm::all(glm::greaterThan(smoke.low + origin, low - 1e-5)));
    EXPECT_TRUE(glm::all(glm::lessThan(smoke.high + origin, high + 1e-5)));

    // Smoke rises off the cube, whose middle is at (1, 2, 0.5).
    std::vector<std::string> notes;
    const std::size_t index = index_of(film, "Domain");
    const auto grids = scene::read_volume(film.volumes[index], 5, notes);
    const glm::dmat4 to_world = world.volumes[index].world_from_object * grids->object_from_index;
    glm::dvec4 sum(0);
    for (int z = 0; z < 32; ++z)
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x)
                sum += static_cast<double>(grids->density.at({x, y, z})) * (to_world * glm::dvec4(x, y, z, 1));
    const glm::dvec3 middle = glm::dvec3(sum / sum.w) + origin;
    EXPECT_NEAR(middle.x, 1, 0.1);
    EXPECT_NEAR(middle.z, -2, 0.1);
    EXPECT_GT(middle.y, 0.45);
    EXPECT_LT(middle.y, 1.5);
}

}  // namespace
}  // namespace render2mpeg::test
