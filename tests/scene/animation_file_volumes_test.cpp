// Volumes of animation files, and what they become.
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "scene/load.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "scene/preparation/traits.h"
#include "support/program.h"
#include "vdb_file.h"

namespace render2mpeg::scene {
namespace {

class AnimationFileVolumes : public ::testing::Test {
  protected:
    AnimationFileVolumes() {
        std::filesystem::create_directories(folder_ / "smoke");
        test::VdbFile::Place place;
        for (int number = 7; number < 11; ++number) {
            place.high = glm::ivec3(number);
            test::VdbFile().add_even("density", place, 1).write(file(number));
        }
    }
    std::filesystem::path file(int number) const {
        return folder_ / ("smoke/smoke_" + std::string(number < 10 ? "000" : "00") + std::to_string(number) + ".vdb");
    }

    Animation film(const std::string& volume, const std::string& more = "") const {
        std::ofstream(folder_ / "film.json") << "{\"volumes\": [" + volume + "]" + more + "}";
        Animation film = load_as_is(folder_ / "film.json", {});
        complete(film, DefaultLight::none);
        return film;
    }
    void expect_complaint(const std::string& volume, const std::string& line) const {
        try {
            film(volume);
        } catch (const core::Error& error) {
            EXPECT_EQ(std::string(error.what()), "reading " + (folder_ / "film.json").string() + ": " + line);
            return;
        }
        ADD_FAILURE() << volume << " is accepted";
    }

    support::Folder folder_;
};

Snapshot frame_of(const Animation& film, std::int64_t frame) {
    return snapshot_at(film, frame, {frame, 25}, {16, 16, 1});
}

TEST_F(AnimationFileVolumes, ShowNumberedFilesFrameByFrame) {
    const Animation film = this->film(
        R"({"file": "smoke/smoke_%04d.vdb", "frames": [7, 10], "first_frame": 2, "position": [0, 0, 5], "scale": 2})");
    const Volume& volume = film.volumes.at(0);
    ASSERT_EQ(volume.files.size(), 4u);
    EXPECT_EQ(volume.files[3], file(10));
    EXPECT_EQ(frame_of(film, 0).volumes.at(0).file, 0u);
    EXPECT_EQ(frame_of(film, 3).volumes.at(0).file, 1u);
    EXPECT_EQ(frame_of(film, 50).volumes.at(0).file, 3u);
    EXPECT_NEAR(film.duration, 6 / 25.0, 1e-7);

    // The box holds every file's.
    EXPECT_EQ(volume.outline.box.low, glm::dvec3(-0.5));
    EXPECT_EQ(volume.outline.box.high, glm::dvec3(10.5));
    EXPECT_EQ(frame_of(film, 0).volumes.at(0).world_from_object[3] + glm::dvec4(film.origin, 0),
              glm::dvec4(0, 0, 5, 1));
    const Extent extent = extent_at(film, 0).value();
    EXPECT_EQ(extent.low, glm::dvec3(-1, -1, 4));
    EXPECT_EQ(extent.high, glm::dvec3(21, 21, 26));
    const Traits traits = traits_of(film);
    EXPECT_TRUE(traits.has_volumes && traits.volumes_change && traits.changes_light());
}

TEST_F(AnimationFileVolumes, KeepWhatTheySay) {
    const Animation film = this->film(R"({"name": "fire", "file": ["smoke/smoke_0008.vdb"], "density": 3,
        "color": [0.1, 0.2, 0.3], "anisotropy": -0.4, "absorption_color": 0.5, "emission": 6, "emission_color": [2, 1, 0],
        "blackbody": 0.7, "blackbody_tint": [1, 0.5, 0], "temperature": 1500, "temperature_grid": "density"})");
    const Volume& v = film.volumes.at(0);
    EXPECT_EQ(v.name, "fire");
    EXPECT_EQ(v.density, 3);
    EXPECT_EQ(v.color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(v.anisotropy, -0.4f);
    EXPECT_EQ(v.absorption_color, glm::vec3(0.5f));
    EXPECT_EQ(v.emission_strength, 6);
    EXPECT_EQ(v.emission_color, glm::vec3(2, 1, 0));
    EXPECT_EQ(v.blackbody_intensity, 0.7f);
    EXPECT_EQ(v.blackbody_tint, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(v.temperature, 1500);
    EXPECT_EQ(v.temperature_grid, "density");
    EXPECT_FALSE(traits_of(film).volumes_change);
}

TEST_F(AnimationFileVolumes, FillBoxesEvenly) {
    const Animation film = this->film(R"({"size": [1, 2, 3], "position": [0, 1, 0]})");
    const Extent extent = extent_at(film, 0).value();
    EXPECT_LT(glm::distance(extent.low, glm::dvec3(-0.5, 0, -1.5)), 1e-12);
    EXPECT_LT(glm::distance(extent.high, glm::dvec3(0.5, 2, 1.5)), 1e-12);
    EXPECT_EQ(film.volumes.at(0).grids->density.at({32, 32, 32}), 1);
}

TEST_F(AnimationFileVolumes, GoWithNodesAndHide) {
    const Animation film =
        this->film(R"({"size": 1, "node": "lift", "keys": [{"at": 0, "visible": true}, {"at": 1, "visible": false}]})",
                   R"(, "objects": [{"name": "lift", "shape": "box", "position": [3, 4, 5]}])");
    const Snapshot first = frame_of(film, 0);
    EXPECT_EQ(first.volumes.at(0).world_from_object[3] + glm::dvec4(film.origin, 0), glm::dvec4(3, 4, 5, 1));
    EXPECT_TRUE(first.volumes.at(0).present);
    EXPECT_FALSE(frame_of(film, 30).volumes.at(0).present);
}

TEST_F(AnimationFileVolumes, RefuseWhatTheyCannotBe) {
    expect_complaint(R"({})", "volumes[0]: has either a `file`, or the `size` of a box that it fills evenly");
    expect_complaint(R"({"file": "smoke/smoke_%04d.vdb"})",
                     "volumes[0].file: names files by their numbers; `frames`, [first, last], tells which there are");
    expect_complaint(R"({"file": "smoke/smoke_0007.vdb", "frames": [1, 2]})",
                     "volumes[0].frames: is of files with %d in their name");
    expect_complaint(R"({"file": "smoke/smoke_%04d.vdb", "frames": [7, 11]})",
                     "volumes[0].file: there is no file \"smoke/smoke_0011.vdb\" in the film's folder");
    expect_complaint(R"({"file": "../smoke.vdb"})",
                     "volumes[0].file: \"../smoke.vdb\" lies outside of the film's own folder");
    expect_complaint(R"({"size": 1, "density_grid": "density"})",
                     "volumes[0].density_grid: is of volumes with a `file`");
    expect_complaint(R"({"size": 1, "anisotropy": 1})",
                     "volumes[0].anisotropy: expected a number from -0.95 to 0.95, found 1");
    expect_complaint(R"({"size": 1, "node": "lft"})", "volumes[0].node: there is no node \"lft\"");
}

TEST_F(AnimationFileVolumes, AreCheckedHoweverTheyCame) {
    const auto refused = [](auto&& change) {
        Animation film;
        film.source = "film";
        film.volumes.emplace_back().name = "smoke";
        film.volumes[0].grids = std::make_shared<VolumeGrids>(even_grids(glm::dvec3(0), glm::dvec3(1)));
        change(film.volumes[0]);
        try {
            complete(film);
        } catch (const core::Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refused([](Volume&) {}), "");
    const std::string of = "reading film: volume 0 \"smoke\": ";
    EXPECT_EQ(refused([](Volume& v) { v.density = -1; }), of + "its density must be finite and not negative");
    EXPECT_EQ(refused([](Volume& v) { v.color.y = 1.5f; }), of + "its colour must lie between 0 and 1");
    EXPECT_EQ(refused([](Volume& v) { v.anisotropy = 1; }), of + "its anisotropy must lie between -0.95 and 0.95");
    EXPECT_EQ(refused([](Volume& v) { v.node = 3; }), of + "its node is none");
    EXPECT_EQ(refused([](Volume& v) { v.grids.reset(); }), of + "it has neither files nor grids");
    EXPECT_EQ(refused([](Volume& v) { v.temperature = -5; }), of + "its temperature must lie between 0 and 1e6 kelvin");
}

}  // namespace
}  // namespace render2mpeg::scene
