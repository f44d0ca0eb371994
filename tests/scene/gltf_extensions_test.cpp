// Extensions of glTF that change what is drawn, where and when.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "gltf_file.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

using test::GltfFile;

class GltfExtensions : public ::testing::Test {
  protected:
    Animation loaded(const GltfFile& file, LoadOptions options = {}) {
        options.light = DefaultLight::even;  // adds no objects
        return load(file.write(folder_ / "film.gltf"), options);
    }
    static bool has_note(const Animation& film, const std::string& part) {
        return std::any_of(film.notes.begin(), film.notes.end(),
                           [&](const std::string& n) { return n.find(part) != std::string::npos; });
    }
    static Snapshot at(const Animation& film, int seconds) { return snapshot_at(film, 0, {seconds, 1}, {64, 64, 1}); }
    /// Adds an animation with one channel of the extension, keys at 0 and 1 s.
    static void point(GltfFile& file, const std::string& pointer, const std::vector<float>& values,
                      const std::string& type = "SCALAR") {
        const int times = file.add_floats({0, 1}, "SCALAR"), keys = file.add_floats(values, type);
        file.append(
            "animations",
            {{"samplers", {{{"input", times}, {"output", keys}}}},
             {"channels",
              {{{"sampler", 0},
                {"target",
                 {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}});
    }
    support::Folder folder_;
};

TEST_F(GltfExtensions, InstancesAreCopiesBelowTheirNode) {
    GltfFile file = GltfFile::triangle();
    const int places = file.add_floats({0, 0, 0, 2, 0, 0, 0, 3, 0}, "VEC3"),
              turns = file.add_floats({0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1}, "VEC4"),
              sizes = file.add_floats({1, 1, 1, 1, 1, 1, 2, 2, 2}, "VEC3");
    file.json["nodes"][0]["translation"] = {10, 0, 0};
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", places}, {"ROTATION", turns}, {"SCALE", sizes}};
    const Animation film = loaded(file);
    ASSERT_EQ(film.objects.size(), 3u);
    EXPECT_EQ(film.meshes.size(), 1u);
    const Snapshot now = at(film, 0);
    const auto corner = [&](std::size_t object, glm::vec3 p) {
        return glm::vec3(now.objects[object].to_world * glm::vec4(p, 1)) + glm::vec3(film.origin);
    };
    EXPECT_LT(glm::distance(corner(0, {1, 0, 0}), {11, 0, 0}), 1e-5f);
    EXPECT_LT(glm::distance(corner(1, {1, 0, 0}), {11, 0, 0}), 1e-5f);  // half a turn about z
    EXPECT_LT(glm::distance(corner(2, {1, 0, 0}), {12, 3, 0}), 1e-5f);

    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        file.add_floats({1, 1, 1}, "VEC3");
    EXPECT_THROW(loaded(file), core::Error);
}

TEST_F(GltfExtensions, HiddenNodesAreLeftOutWithWhatIsBelowThem) {
    GltfFile file = GltfFile::triangle();
    file.append("nodes", {{"mesh", 0}, {"name", "below"}});
    file.append("nodes", {{"mesh", 0}, {"name", "beside"}});
    file.json["nodes"][0]["children"] = {1};
    file.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
    file.json["scenes"][0]["nodes"] = {0, 2};
    const Animation film = loaded(file);
    ASSERT_EQ(film.objects.size(), 1u);
    EXPECT_EQ(film.objects[0].name, "beside");
}

TEST_F(GltfExtensions, VisibilityIsAnimated) {
    GltfFile file = GltfFile::triangle();
    file.append("nodes", {{"mesh", 0}});
    file.json["scenes"][0]["nodes"] = {0, 1};
    file.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
    point(file, "/nodes/0/extensions/KHR_node_visibility/visible", {0, 1});
    file.json["animations"][0]["samplers"][0]["interpolation"] = "STEP";
    const Animation film = loaded(file);
    ASSERT_EQ(film.objects.size(), 2u);
    EXPECT_FALSE(at(film, 0).objects[0].present);
    EXPECT_TRUE(at(film, 1).objects[0].present);
}

TEST_F(GltfExtensions, PointersMoveLampsEmissionAndLenses) {
    GltfFile file = GltfFile::triangle();
    file.append("materials", {{"emissiveFactor", {0, 0, 0}},
                              {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
    file.primitive()["material"] = 0;
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}}};
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    file.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    file.json["nodes"][0]["camera"] = 0;
    point(file, "/extensions/KHR_lights_punctual/lights/0/intensity", {10, 20});
    point(file, "/cameras/0/perspective/yfov", {0.5, 0.75});
    point(file, "/materials/0/emissiveFactor", {0.25, 0.5, 0, 0, 0, 0}, "VEC3");
    point(file, "/nodes/0/translation", {0, 0, 0, 0, 7, 0}, "VEC3");
    point(file, "/materials/0/pbrMetallicRoughness/baseColorFactor", {0.5, 1, 0, 1, 1, 0, 0, 0.5}, "VEC4");
    point(file, "/extensions/KHR_lights_punctual/lights/0/color", {1, 0, 0, 0, 1, 0}, "VEC3");
    point(file, "/materials/0/pbrMetallicRoughness/roughnessFactor", {1, 0});
    const Animation film = loaded(file);
    const Snapshot begin = at(film, 0), end = at(film, 1);
    EXPECT_FLOAT_EQ(begin.lights[0].intensity.x, 10);
    EXPECT_FLOAT_EQ(end.lights[0].intensity.y, 20);
    EXPECT_FLOAT_EQ(begin.camera.lens().vertical_fov, 0.5f);
    EXPECT_FLOAT_EQ(end.camera.lens().vertical_fov, 0.75f);
    EXPECT_EQ(film.materials[0].emission * begin.emission_factor[0], glm::vec3(1, 2, 0));
    EXPECT_EQ(end.emission_factor[0], 0);
    EXPECT_FLOAT_EQ(end.objects[0].to_world[3].y - begin.objects[0].to_world[3].y, 7);
    EXPECT_EQ(begin.base_color[0], glm::vec4(0.5f, 1, 0, 1));
    EXPECT_EQ(end.base_color[0], glm::vec4(1, 0, 0, 0.5f));
    EXPECT_EQ(film.materials[0].base_color, glm::vec4(1, 1, 0, 1));
    EXPECT_EQ(film.objects[0].mobility, Mobility::rigid);
    EXPECT_EQ(end.lights[0].intensity, glm::vec3(0, 20, 0));
    EXPECT_TRUE(has_note(film, "roughnessFactor"));
}

TEST_F(GltfExtensions, VariantsChooseMaterials) {
    GltfFile file = GltfFile::triangle();
    for (const char* name : {"own", "red", "blue"}) file.append("materials", {{"name", name}});
    file.primitive()["material"] = 0;
    file.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "warm"}}, {{"name", "cold"}}};
    file.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                            {{"material", 2}, {"variants", {1}}}};
    const auto shown = [&](const Animation& film) {
        return film.materials[static_cast<std::size_t>(film.objects[0].material)].name;
    };
    LoadOptions options;
    EXPECT_EQ(shown(loaded(file)), "own");
    EXPECT_TRUE(has_note(loaded(file), "\"warm\", \"cold\""));
    options.variant = "cold";
    EXPECT_EQ(shown(loaded(file, options)), "blue");
    options.variant = "0";
    EXPECT_EQ(shown(loaded(file, options)), "red");
    options.variant = "loud";
    EXPECT_THROW(loaded(file, options), core::Error);
}

TEST_F(GltfExtensions, WebpIsTakenBeforeTheOtherImage) {
    GltfFile file = GltfFile::triangle();
    file.append("images", {{"uri", "data:image/png;base64,AAAA"}});
    file.append("images", {{"uri", "data:image/webp;base64,BBBB"}});
    file.append("textures", {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    file.append("materials", {{"emissiveTexture", {{"index", 0}}}});
    const Animation film = loaded(file);
    ASSERT_EQ(film.images.size(), 1u);
    EXPECT_EQ(film.images[0].bytes[0], std::byte{0x04});
}

TEST_F(GltfExtensions, WhatIsNotReadIsToldOnceWithWhatItMeans) {
    GltfFile file = GltfFile::triangle();
    file.json["extensionsUsed"] = {"KHR_gaussian_splatting"};
    file.append("materials", {{"extensions", {{"KHR_gaussian_splatting", nlohmann::json::object()}}}});
    file.append("materials", {{"extensions", {{"KHR_materials_volume_scatter", nlohmann::json::object()}}}});
    file.append("materials", {{"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}});
    const Animation film = loaded(file);
    EXPECT_TRUE(has_note(film, "splats are not drawn"));
    EXPECT_TRUE(has_note(film, "nothing scatters light inside (the file uses it and does not list it)"));
    EXPECT_TRUE(has_note(film, "\"KHR_materials_unlit\", which it does not list"));
}

}  // namespace
}  // namespace render2mpeg::scene
