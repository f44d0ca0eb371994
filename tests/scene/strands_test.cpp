#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>
#include <utility>

#include "core/error.h"
#include "scene/gltf_file.h"
#include "scene/load.h"
#include "scene/model/curves.h"
#include "scene/preparation/traits.h"
#include "support/program.h"
#include "tests/support/scene_builder.h"

// Strands of hair: from files, and refused where they are broken.
namespace render2mpeg::scene {
namespace {

using test::GltfFile;

TEST(StrandFiles, OfAnAnimationFileAreStrandsWithTheirFibres) {
    const support::Folder folder;
    std::ofstream(folder / "film.json") << R"({
        "materials": { "fur": { "hair": { "melanin": 0.5, "redness": 0, "tilt": 0 } }, "wax": { "subsurface": { "free_path": [2, 1, 0.5] } } },
        "objects": [{ "shape": "strands", "strands": [[[0, 0, 0], [0, 1, 0], [0, 2, 1]], [[1, 0, 0], [1, 1, 0]]],
                      "radius": 0.2, "tip_radius": 0, "material": "fur" },
                    { "shape": "box", "material": "wax" }]})";
    const Animation film = load(folder / "film.json");
    const Object& fur = film.objects.at(0);
    const Mesh& mesh = film.meshes.at(static_cast<std::size_t>(fur.mesh));
    ASSERT_EQ(mesh.curves.size(), 3u);
    EXPECT_FLOAT_EQ(mesh.radii[mesh.curves[1] + 1], 0.1f);
    EXPECT_EQ(mesh.positions[mesh.curves[2] + 1], glm::vec3(1, 0, 0));
    const Material& material = film.materials.at(static_cast<std::size_t>(fur.material));
    ASSERT_TRUE(material.hair);
    EXPECT_NEAR(material.hair->absorption.x, 0.506 * std::log(2.0), 1e-5);
    EXPECT_EQ(material.hair->tilt, 0);
    const auto& wax = film.materials.at(static_cast<std::size_t>(film.objects.at(1).material)).subsurface;
    ASSERT_TRUE(wax);
    EXPECT_EQ(wax->free_path, glm::vec3(2, 1, 0.5f));
    EXPECT_TRUE(traits_of(film).has_hair && traits_of(film).has_subsurface);
}

TEST(StrandFiles, OfGltfAreLinesWithRadii) {
    const support::Folder folder;
    GltfFile file = GltfFile::triangle();
    const int positions = file.add_floats({0, 0, 0, 0, 1, 0, 0, 2, 0, 1, 0, 0, 1, 1, 0}, "VEC3"),
              radii = file.add_floats({0.3f, 0.2f, 0.1f, 0.5f, 0.4f}, "SCALAR"),
              lines = file.add_accessor(std::vector<std::uint16_t>{0, 1, 1, 2, 3, 4}, GltfFile::uint16, "SCALAR");
    file.primitive() = {{"mode", 1}, {"indices", lines}, {"attributes", {{"POSITION", positions}, {"_RADIUS", radii}}}};
    const Animation film = load(file.write(folder / "film.gltf"));
    const Mesh& mesh = film.meshes.at(0);
    ASSERT_EQ(mesh.curves.size(), 3u);
    EXPECT_EQ(mesh.positions[mesh.curves[1] + 2], glm::vec3(0, 2, 0));
    EXPECT_EQ(mesh.positions[mesh.curves[2] + 1], glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.radii[mesh.curves[2] + 2], 0.4f);
}

Animation film_of(const Mesh& mesh) {
    test::SceneBuilder b;
    b.add_object(b.add_mesh(mesh), b.add_material());
    return b.build();
}

std::string complaint_of(const Mesh& mesh) {
    try {
        film_of(mesh);
    } catch (const core::Error& error) {
        return error.what();
    }
    return {};
}

TEST(Strands, ThatAreBrokenAreRefusedByNameAndThoseWithoutWidthAreLeftOut) {
    Mesh good;
    good.name = "fur";
    const glm::vec3 points[] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
    const float radii[] = {0.1f, 0.1f, 0};
    add_strand(good, points, radii);
    EXPECT_EQ(complaint_of(good), "");
    const auto broken = [&](auto change) {
        Mesh mesh = good;
        change(mesh);
        const std::string said = complaint_of(mesh);
        EXPECT_NE(said.find("fur"), std::string::npos) << said;
        return said;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    // A second strand, whose points are named as files have them.
    EXPECT_EQ(add_strand(good, points, radii), 6u);
    const std::pair<std::string, std::function<void(Mesh&)>> all[] = {
        {"point 1 of strand 0 is not finite", [&](Mesh& m) { m.positions[2].y = nan; }},
        {"point 0 of strand 1 has a radius that is not finite", [&](Mesh& m) { m.radii[5] = m.radii[6] = nan; }},
        {"point 2 of strand 1 has a radius below 0", [&](Mesh& m) { m.radii[8] = -1; }},
        {"point 1 of strand 1 has a radius above 1000000", [&](Mesh& m) { m.radii[7] = 2e6f; }}};
    for (const auto& [cause, change] : all) EXPECT_NE(broken(change).find(cause), std::string::npos) << cause;
    EXPECT_NE(broken([&](Mesh& m) { m.radii.pop_back(); }).find("radii"), std::string::npos);
    EXPECT_NE(broken([&](Mesh& m) { m.curves[0] = 7; }).find("segment 0"), std::string::npos);
    test::SceneBuilder b;
    const int glowing = b.add_material();
    b.material(glowing).emission = glm::vec3(1);
    b.add_object(b.add_mesh(good), glowing);
    EXPECT_NE(std::string(b.build().notes.front()).find("its strands are seen to shine"), std::string::npos);
    Mesh thin = good;
    thin.radii.assign(thin.radii.size(), 0.0f);
    EXPECT_TRUE(film_of(thin).objects.empty());
}

}  // namespace
}  // namespace render2mpeg::scene
