// Volumes' files.
#include "scene/volumes/volume_reader.h"

#include <gtest/gtest.h>

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <thread>

#include "core/error.h"
#include "support/program.h"
#include "vdb_file.h"

namespace render2mpeg::scene {
namespace {

using test::VdbFile;

float hump(glm::ivec3 p) {
    return 1 + 0.01f * static_cast<float>(p.x + 3 * p.y - 2 * p.z);
}

/// A box that no bricks' borders bound.
VdbFile::Place small_box() {
    VdbFile::Place place;
    place.low = {-5, 2, 6};
    place.high = {11, 9, 20};
    return place;
}

template <class Do>
void each_voxel(glm::ivec3 low, glm::ivec3 high, const Do& todo) {
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) todo(glm::ivec3(x, y, z));
}

class VolumeFile : public ::testing::Test {
  protected:
    VolumeGrids read(const VdbFile& file) {
        volume_.files = {file.write(folder_ / "smoke.vdb")};
        notes_.clear();
        return *read_volume(volume_, 0, notes_);
    }

    std::string refusal(const VdbFile& file) {
        volume_.files = {file.write(folder_ / "smoke.vdb")};
        return refusal();
    }
    /// Of both ways in, which say the same where the file's head tells.
    std::string refusal() {
        std::string all;
        for (const bool head : {true, false}) {
            try {
                head ? static_cast<void>(outline_of(volume_)) : static_cast<void>(read_volume(volume_, 0, notes_));
            } catch (const core::Error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
                if (all != error.what()) all += error.what();
            }
        }
        return all.empty() ? "nothing" : all;
    }
    std::string named(const std::string& rest) { return "reading " + (folder_ / "smoke.vdb").string() + ": " + rest; }

    support::Folder folder_;
    Volume volume_;
    std::vector<std::string> notes_;
};

TEST_F(VolumeFile, KeepsEveryVoxelInItsPlace) {
    VdbFile::Place place = small_box();
    place.object_from_index =
        glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(1, 2, 3)), glm::dvec3(0.125, 0.25, 0.5));
    volume_.color_grid = "tint";
    const VolumeGrids grids = read(VdbFile().add("density", place, hump).add("tint", place, [](glm::ivec3 p) {
        return glm::vec3(0.1f, 0.2f, 0.03f * float(p.y));
    }));
    EXPECT_EQ(grids.object_from_index, place.object_from_index);
    each_voxel(place.low - 9, place.high + 9, [&](glm::ivec3 p) {
        const bool within =
            glm::all(glm::greaterThanEqual(p, place.low)) && glm::all(glm::lessThanEqual(p, place.high));
        EXPECT_EQ(grids.density.at(p), within ? hump(p) : 0.0f);
        EXPECT_EQ(grids.color.at(p), within ? glm::vec3(0.1f, 0.2f, 0.03f * float(p.y)) : glm::vec3(0));
    });
    EXPECT_TRUE(grids.temperature.empty());
    EXPECT_TRUE(notes_.empty());

    const VolumeBox box = outline_of(volume_).box;
    EXPECT_LT(glm::distance(box.low, glm::dvec3(1, 2, 3) + glm::dvec3(-0.6875, 0.375, 2.75)), 1e-12);
    EXPECT_LT(glm::distance(box.high, glm::dvec3(1, 2, 3) + glm::dvec3(1.4375, 2.375, 10.25)), 1e-12);
}

TEST_F(VolumeFile, ReadsHalfFloats) {
    VdbFile::Place place = small_box();
    place.half = true;
    const VolumeGrids grids = read(VdbFile().add("density", place, hump));
    each_voxel(place.low, place.high, [&](glm::ivec3 p) { EXPECT_NEAR(grids.density.at(p), hump(p), 1e-3f); });
}

TEST_F(VolumeFile, FillsBricksOfConstantNodes) {
    VdbFile::Place place;
    place.low = {-3, 0, 0};
    place.high = {140, 15, 130};
    const VolumeGrids grids = read(VdbFile().add_even("density", place, 0.25f));
    EXPECT_EQ(grids.density.count(), 19u * 2u * 17u);
    for (const glm::ivec3 p : {place.low, place.high, glm::ivec3(64, 8, 64)}) EXPECT_EQ(grids.density.at(p), 0.25f);
    for (const glm::ivec3 p : {place.low - 1, place.high + 1, glm::ivec3(64, 16, 64)})
        EXPECT_EQ(grids.density.at(p), 0.0f);
}

TEST_F(VolumeFile, SamplesOtherGridsAtTheVoxelsOfDensity) {
    // A linear function is what interpolation keeps.
    VdbFile::Place place = small_box(), other;
    place.object_from_index = glm::scale(glm::dmat4(1), glm::dvec3(0.5));
    other.low = glm::ivec3(-30);
    other.high = glm::ivec3(30);
    other.object_from_index =
        glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(0.3, 0.2, 4)), 0.4, glm::dvec3(1, 2, 3));
    const auto heat = [](glm::dvec3 p) { return 50 + p.x - 2 * p.y + 0.5 * p.z; };
    volume_.blackbody_intensity = 1;
    const VolumeGrids grids = read(VdbFile().add("density", place, hump).add("temperature", other, [&](glm::ivec3 p) {
        return float(heat(glm::dvec3(other.object_from_index * glm::dvec4(p, 1))));
    }));
    each_voxel(place.low, place.high,
               [&](glm::ivec3 p) { EXPECT_NEAR(double(grids.temperature.at(p)), heat(0.5 * glm::dvec3(p)), 1e-4); });
    // Heat reaches farther than smoke does.
    EXPECT_NEAR(double(grids.temperature.at(place.high + 12)), heat(0.5 * glm::dvec3(place.high + 12)), 1e-4);
    EXPECT_EQ(grids.temperature.at(glm::ivec3(400)), 0.0f);
}

TEST_F(VolumeFile, JoinsAColourOfThreeGrids) {
    const VdbFile::Place place = small_box();
    volume_.color_grid = "color";
    VdbFile file;
    file.add("density", place, hump);
    for (const char* const channel : {"color_r", "color_g", "color_b"})
        file.add(channel, place, [channel](glm::ivec3) { return channel[6] == 'g' ? 0.5f : 0.25f; });
    EXPECT_EQ(read(file).color.at(place.high), glm::vec3(0.25f, 0.5f, 0.25f));
}

TEST_F(VolumeFile, LooksForWhatAFileLacksInAnother) {
    volume_.blackbody_intensity = 1;
    volume_.more_files = {VdbFile()
                              .add("temperature", small_box(), hump)
                              .add("density", small_box(), [](glm::ivec3) { return 9.0f; })
                              .write(folder_ / "heat.vdb")};
    const VolumeGrids grids = read(VdbFile().add("density", small_box(), hump));
    const glm::ivec3 p = small_box().high;
    EXPECT_EQ(grids.density.at(p), hump(p));
    EXPECT_EQ(grids.temperature.at(p), hump(p));
    volume_.temperature_grid = "heat";
    EXPECT_EQ(refusal(), named("grid \"heat\": there is none; there are \"density\", \"density\", \"temperature\""));
}

TEST_F(VolumeFile, TellsOfValuesThatNoMediumHas) {
    const VdbFile::Place place = small_box();
    volume_.color_grid = "tint";
    const VolumeGrids grids =
        read(VdbFile()
                 .add("density", place,
                      [&](glm::ivec3 p) {
                          if (p == place.low) return -1.0f;
                          return p == place.high ? std::numeric_limits<float>::quiet_NaN() : 1.0f;
                      })
                 .add("tint", place, [&](glm::ivec3 p) {
                     return p == place.low ? glm::vec3(2, -1, std::numeric_limits<float>::infinity()) : glm::vec3(0.5f);
                 }));
    EXPECT_EQ(grids.density.at(place.low), 0);
    EXPECT_EQ(grids.density.at(place.high), 0);
    EXPECT_EQ(grids.density.at(place.low + 1), 1);
    EXPECT_EQ(grids.color.at(place.low), glm::vec3(1, 0, 0));
    const std::string file = volume_.files[0].string();
    EXPECT_EQ(notes_, (std::vector{file + ": grid \"density\": 2 values below 0 or not finite became 0",
                                   file + ": grid \"tint\": 1 value became colours from 0 to 1"}));
}

TEST_F(VolumeFile, RefusesWhatItDoesNotRead) {
    EXPECT_EQ(refusal(VdbFile().add("smoke", {}, hump).add("heat", {}, hump)),
              named("grid \"density\": there is none; there are \"heat\", \"smoke\""));
    EXPECT_EQ(refusal(VdbFile().add_frustum("density")),
              named("grid \"density\": its transform is a frustum; only affine ones are read"));
    EXPECT_EQ(refusal(VdbFile().add_whole_numbers("density")),
              named("grid \"density\": holds values of type int32; float is read here"));
    VdbFile::Place place;
    place.level_set = true;
    EXPECT_EQ(refusal(VdbFile().add("density", place, hump)),
              named("grid \"density\": is a level set, whose values are distances"));
    volume_.files = {folder_ / "none.vdb"};
    EXPECT_NE(refusal().find("none.vdb"), std::string::npos);
}

TEST_F(VolumeFile, RefusesWhatTakesTooMuch) {
    VdbFile::Place place;
    place.low = glm::ivec3(-2048);
    place.high = glm::ivec3(2047);
    EXPECT_EQ(
        refusal(VdbFile().add_even("density", place, 1)),
        named("grid \"density\": spans 4096 x 4096 x 4096 voxels; at most 2048^3, or as many otherwise, are read"));
    place.low = glm::ivec3(0);
    place.high = glm::ivec3(1023);
    EXPECT_EQ(refusal(VdbFile().add_even("density", place, 1)),
              named("grid \"density\": takes, with those before it, more than 2 GiB; scale the file's voxels up"));
}

TEST_F(VolumeFile, RefusesDamagedFilesInOneLine) {
    volume_.files = {VdbFile().add("density", small_box(), hump).write(folder_ / "smoke.vdb")};
    const std::string whole = support::contents(volume_.files[0]);
    for (const std::size_t length : {std::size_t{0}, std::size_t{7}, whole.size() / 2, whole.size() - 500}) {
        std::ofstream(volume_.files[0], std::ios::binary) << whole.substr(0, length);
        EXPECT_THROW(read_volume(volume_, 0, notes_), core::Error) << length;
        EXPECT_NE(refusal(), "nothing") << length;
    }
}

#ifndef RENDER2MPEG_SANITIZED  // sanitizers take terabytes of addresses: readers have no limit under them
TEST_F(VolumeFile, RefusesTextThatItsBytesCannotHold) {
    if (!Probe::is_possible()) GTEST_SKIP() << "render2mpeg is not built";
    std::string bytes = support::contents(support::source_folder() / "tests/fuzz/corpus/volume/even.vdb");
    // A kind of value that nobody knows, and a text of 128 bytes, behind which a length is 2 GiB and more.
    bytes.replace(148, 4, std::string("\0\0\0\x80", 4));
    bytes[155] = '\0';
    volume_.files = {folder_ / "smoke.vdb"};
    std::ofstream(volume_.files[0], std::ios::binary) << bytes;
    EXPECT_NE(refusal().find("takes more memory than a file of its size can need: it is damaged"), std::string::npos)
        << refusal();
}
#endif

TEST_F(VolumeFile, TellsWhatItsGridsWillTake) {
    // Bricks, and even nodes of them; a grid of voxels twice as wide has an eighth of them.
    VdbFile::Place bricks = small_box(), even, wide;
    bricks.high = bricks.low + 99;
    even.high = glm::ivec3(127);
    wide.high = glm::ivec3(31);
    wide.object_from_index = glm::scale(glm::dmat4(1), glm::dvec3(2));
    volume_.blackbody_intensity = 1;
    const VdbFile::Amount uneven = [](glm::ivec3 p) { return 1 + static_cast<float>(p.x & 7); };
    for (const bool is_even : {false, true}) {
        VdbFile file;
        if (is_even)
            file.add_even("density", even, 0.5f).add_even("temperature", wide, 1);
        else
            file.add("density", bricks, uneven).add("temperature", bricks, uneven);
        const auto taken = static_cast<double>(outline_of(read(file)).bytes);
        const auto told = static_cast<double>(outline_of(volume_).bytes);
        EXPECT_GT(told, 0.95 * taken) << is_even;
        EXPECT_LT(told, 1.3 * taken + (1 << 20)) << is_even;
    }
}

TEST_F(VolumeFile, HoldsTwoOfASequence) {
    Animation film;
    film.volumes.emplace_back();
    for (int frame = 0; frame < 4; ++frame)
        film.volumes[0].files.push_back(
            VdbFile()
                .add("density", small_box(), [&](glm::ivec3) { return 1 + static_cast<float>(frame); })
                .write(folder_ / ("smoke" + std::to_string(frame) + ".vdb")));
    VolumeReader reader(film);
    std::weak_ptr<const VolumeGrids> first = reader.grids(0, 0);
    const auto second = reader.grids(0, 1);
    EXPECT_EQ(reader.grids(0, 0), first.lock());
    EXPECT_EQ(reader.grids(0, 1), second);
    EXPECT_EQ(reader.grids(0, 2)->density.at({0, 5, 8}), 3);
    EXPECT_TRUE(first.expired());
    EXPECT_EQ(reader.grids(0, 1), second);

    // Threads share what one of them read.
    std::vector<std::shared_ptr<const VolumeGrids>> seen(4);
    std::vector<std::thread> threads;
    for (auto& grids : seen) threads.emplace_back([&] { grids = reader.grids(0, 3); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& grids : seen) EXPECT_EQ(grids, seen[0]);
    EXPECT_EQ(seen[0]->density.at({0, 5, 8}), 4);
}

TEST(Volume, HasFilesByFrame) {
    Volume volume;
    volume.files = {"a", "b", "c"};
    volume.first_frame = 10;
    EXPECT_EQ(volume.file_at(-5), 0u);
    EXPECT_EQ(volume.file_at(10), 0u);
    EXPECT_EQ(volume.file_at(11), 1u);
    EXPECT_EQ(volume.file_at(99), 2u);
}

TEST(Volume, EvenGridsFillABox) {
    Volume volume;
    volume.grids = std::make_shared<VolumeGrids>(even_grids({-1, 0, 2}, {1, 1, 6}));
    const VolumeBox box = outline_of(volume).box;
    EXPECT_LT(glm::distance(box.low, glm::dvec3(-1, 0, 2)), 1e-12);
    EXPECT_LT(glm::distance(box.high, glm::dvec3(1, 1, 6)), 1e-12);
    EXPECT_EQ(volume.grids->density.at(glm::ivec3(0)), 1);
    EXPECT_EQ(volume.grids->density.at(glm::ivec3(63)), 1);
    EXPECT_EQ(volume.grids->density.at(glm::ivec3(64)), 0);
}

}  // namespace
}  // namespace render2mpeg::scene
