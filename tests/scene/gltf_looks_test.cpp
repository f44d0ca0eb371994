#include <gtest/gtest.h>

#include <cmath>

#include "scene/gltf_file.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "support/program.h"

// Materials, textures and lights of glTF, extensions included.
namespace render2mpeg::scene {
namespace {

using test::GltfFile;

class GltfLooks : public ::testing::Test {
  protected:
    Material material(const nlohmann::json& json) {
        GltfFile file = GltfFile::triangle();
        file.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
        file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
        file.json["textures"] = {{{"source", 0}}, {{"source", 0}, {"sampler", 0}}};
        file.json["materials"] = {json};
        file.primitive()["material"] = 0;
        return load(file.write(folder_ / "film.gltf")).materials.at(0);
    }
    support::Folder folder_;
};

TEST_F(GltfLooks, DefaultsAreTheSpecifications) {
    for (const Material& m :
         {material(nlohmann::json::object()), material({{"pbrMetallicRoughness", nlohmann::json::object()}})}) {
        EXPECT_EQ(m.base_color, glm::vec4(1));
        EXPECT_EQ(m.metallic, 1);
        EXPECT_EQ(m.roughness, 1);
        EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
        EXPECT_EQ(m.ior, 1.5f);
        EXPECT_FALSE(m.double_sided || m.unlit || m.emits() || m.specular_glossiness);
    }
    // A primitive without a material has the default one.
    const Animation film = load(GltfFile::triangle().write(folder_ / "film.gltf"));
    EXPECT_EQ(film.materials[static_cast<std::size_t>(film.objects[0].material)].metallic, 1);
}

TEST_F(GltfLooks, MetallicRoughnessIsReadWithItsTextures) {
    const Material m = material({{"pbrMetallicRoughness",
                                  {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                                   {"baseColorTexture", {{"index", 1}, {"texCoord", 1}}},
                                   {"metallicFactor", 0.5},
                                   {"roughnessFactor", 0.25},
                                   {"metallicRoughnessTexture", {{"index", 0}}}}},
                                 {"emissiveFactor", {1, 0.5, 0}},
                                 {"alphaMode", "MASK"},
                                 {"alphaCutoff", 0.3},
                                 {"doubleSided", true}});
    EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.base_color_texture.uv_set, 1);
    EXPECT_EQ(m.base_color_texture.wrap_u, core::Wrap::clamp_to_edge);
    EXPECT_EQ(m.base_color_texture.wrap_v, core::Wrap::mirrored_repeat);
    EXPECT_TRUE(m.base_color_texture.nearest);
    EXPECT_EQ(m.metallic_roughness_texture.wrap_u, core::Wrap::repeat);
    EXPECT_FALSE(m.metallic_roughness_texture.nearest);
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.emission, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.3f);
    EXPECT_TRUE(m.double_sided);
}

TEST_F(GltfLooks, ExtensionsOfMaterialsAreRead) {
    const Material m = material(
        {{"emissiveFactor", {1, 1, 0.5}},
         {"alphaMode", "BLEND"},
         {"extensions",
          {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}},
           {"KHR_materials_unlit", nlohmann::json::object()},
           {"KHR_materials_transmission", {{"transmissionFactor", 0.75}, {"transmissionTexture", {{"index", 0}}}}},
           {"KHR_materials_ior", {{"ior", 1.33}}}}}});
    EXPECT_EQ(m.emission, glm::vec3(20, 20, 10));
    EXPECT_TRUE(m.unlit);
    EXPECT_EQ(m.transmission, 0.75f);
    EXPECT_TRUE(m.transmission_texture.present());
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
}

TEST_F(GltfLooks, LeavesAndBrushedSurfacesAreRead) {
    const Material m = material(
        {{"extensions",
          {{"KHR_materials_anisotropy",
            {{"anisotropyStrength", 0.5}, {"anisotropyRotation", 1.25}, {"anisotropyTexture", {{"index", 0}}}}},
           {"KHR_materials_diffuse_transmission",
            {{"diffuseTransmissionFactor", 0.25},
             {"diffuseTransmissionTexture", {{"index", 0}}},
             {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}},
             {"diffuseTransmissionColorTexture", {{"index", 0}}}}}}}});
    EXPECT_EQ(m.anisotropy, 0.5f);
    EXPECT_EQ(m.anisotropy_rotation, 1.25f);
    EXPECT_TRUE(m.anisotropy_texture.present());
    EXPECT_EQ(m.diffuse_transmission, 0.25f);
    EXPECT_TRUE(m.diffuse_transmission_texture.present());
    EXPECT_EQ(m.diffuse_transmission_color, glm::vec3(1, 0.5f, 0.25f));
    EXPECT_TRUE(m.diffuse_transmission_color_texture.present());
}

TEST_F(GltfLooks, VolumesBoundBodies) {
    const auto volume = [](double thickness) {
        return nlohmann::json{
            {"extensions",
             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_volume",
               {{"thicknessFactor", thickness}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.5, 0.25, 1}}}},
              {"KHR_materials_dispersion", {{"dispersion", 0.3}}}}}};
    };
    const Material m = material(volume(0.1));
    EXPECT_EQ(m.thickness, Thickness::solid);
    EXPECT_EQ(m.attenuation_distance, 0.5f);
    EXPECT_EQ(m.attenuation_color, glm::vec3(0.5f, 0.25f, 1));
    EXPECT_EQ(m.dispersion, 0.3f);
    EXPECT_EQ(material(volume(0)).thickness, Thickness::thin);
    EXPECT_EQ(material(nlohmann::json::object()).thickness, Thickness::thin);
}

TEST_F(GltfLooks, SpecularGlossinessReplacesMetallicRoughness) {
    const Material m = material({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}},
                                 {"extensions",
                                  {{"KHR_materials_pbrSpecularGlossiness",
                                    {{"diffuseFactor", {0.5, 0.25, 0.125, 1}},
                                     {"diffuseTexture", {{"index", 0}}},
                                     {"specularFactor", {0.2, 0.3, 0.4}},
                                     {"glossinessFactor", 0.6},
                                     {"specularGlossinessTexture", {{"index", 0}}}}}}}});
    EXPECT_TRUE(m.specular_glossiness);
    EXPECT_EQ(m.base_color, glm::vec4(0.5f, 0.25f, 0.125f, 1));
    EXPECT_EQ(m.specular, glm::vec3(0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.glossiness, 0.6f);
    EXPECT_TRUE(m.base_color_texture.present() && m.specular_glossiness_texture.present());
}

TEST_F(GltfLooks, TextureTransformsTurnCounterClockwiseOnTheImage) {
    // The extension's own example: the lower left quadrant of the image, turned clockwise.
    const Material m =
        material({{"emissiveTexture",
                   {{"index", 0},
                    {"extensions",
                     {{"KHR_texture_transform",
                       {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}, {"texCoord", 1}}}}}}}});
    EXPECT_EQ(m.emission_texture.uv_set, 1);
    const auto& t = m.emission_texture.transform;
    const auto moved = [&](float u, float v) {
        return glm::vec2(t[0][0] * u + t[0][1] * v + t[0][2], t[1][0] * u + t[1][1] * v + t[1][2]);
    };
    EXPECT_LT(glm::length(moved(0, 0) - glm::vec2(0, 1)), 1e-6);
    EXPECT_LT(glm::length(moved(1, 0) - glm::vec2(0, 0.5)), 1e-6);
    EXPECT_LT(glm::length(moved(0, 1) - glm::vec2(0.5, 1)), 1e-6);
}

TEST_F(GltfLooks, PunctualLightsShineFromTheirNodes) {
    GltfFile file = GltfFile::triangle();
    file.json["extensions"] = {
        {"KHR_lights_punctual",
         {{"lights",
           {{{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}, {"range", 7}},
            {{"type", "spot"}, {"intensity", 3}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
            {{"type", "directional"}, {"name", "sun"}, {"intensity", 2}}}}}}};
    const auto node = [](int light) {
        return nlohmann::json{{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}};
    };
    nlohmann::json point = node(0), spot = node(1), sun = node(2);
    point["translation"] = {1, 2, 3};
    spot["rotation"] = {std::sqrt(0.5), 0, 0, -std::sqrt(0.5)};  // -z to -y
    spot["scale"] = {3, 3, 3};
    file.json["nodes"] = {{{"mesh", 0}}, point, spot, sun};
    file.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
    const Animation film = load(file.write(folder_ / "film.gltf"));
    EXPECT_FALSE(film.sky.shines());
    const Snapshot now = snapshot_at(film, 0, {0, 1}, {64, 64, 1});
    ASSERT_EQ(now.lights.size(), 3u);
    EXPECT_EQ(now.lights[0].intensity, glm::vec3(10, 5, 0));
    EXPECT_EQ(now.lights[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(now.lights[0].range, 7);
    EXPECT_LT(glm::length(now.lights[1].direction - glm::vec3(0, -1, 0)), 1e-6);
    EXPECT_FLOAT_EQ(now.lights[1].cos_inner, std::cos(0.25f));
    EXPECT_FLOAT_EQ(now.lights[1].cos_outer, std::cos(0.5f));
    EXPECT_EQ(now.lights[2].direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(now.lights[2].id, 2u);
}

TEST_F(GltfLooks, FactorsOutOfRangeAreClampedAndSaidSo) {
    GltfFile file = GltfFile::triangle();
    file.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorFactor", {2, 0.5, 0.5, 1}}, {"roughnessFactor", -1}}}}};
    const Animation film = load(file.write(folder_ / "film.gltf"));
    EXPECT_EQ(film.materials[0].base_color.x, 1);
    EXPECT_EQ(film.materials[0].roughness, 0);
    EXPECT_EQ(std::count_if(film.notes.begin(), film.notes.end(),
                            [](const std::string& n) { return n.find("out of range") != std::string::npos; }),
              2);
}

}  // namespace
}  // namespace render2mpeg::scene
