#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/gltf_file.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

using test::GltfFile;

class Gltf : public ::testing::Test {
  protected:
    Animation load_file(const GltfFile& file, LoadOptions options = {}) {
        options.light = DefaultLight::even;  // adds no objects
        return load(file.write(folder_ / "film.gltf"), options);
    }
    static bool has_note(const Animation& film, const std::string& part) {
        return std::any_of(film.notes.begin(), film.notes.end(),
                           [&](const std::string& n) { return n.find(part) != std::string::npos; });
    }
    support::Folder folder_;
};

Snapshot gltf_at(const Animation& film, double seconds) {
    return snapshot_at(film, 0, {static_cast<std::int64_t>(std::llround(seconds * 1000)), 1000}, {64, 64, 1});
}

TEST_F(Gltf, TextAndBinaryFilesReadAlike) {
    GltfFile file = GltfFile::triangle();
    const Animation text = load_file(file),
                    binary = load(file.write_binary(folder_ / "film.glb"), {.light = DefaultLight::even});
    ASSERT_EQ(text.meshes.size(), 1u);
    EXPECT_EQ(text.meshes[0].positions, binary.meshes[0].positions);
    EXPECT_EQ(text.meshes[0].positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(text.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}}));
    EXPECT_EQ(text.objects[0].name, "thing");
}

TEST_F(Gltf, BuffersAndImagesMayLieBesideTheFileUnderPercentEncodedNames) {
    GltfFile file = GltfFile::triangle();
    std::filesystem::create_directory(folder_ / "sub");
    GltfFile::write_text(folder_ / "sub" / "my data.bin", std::string(file.binary.begin(), file.binary.end()) + "more");
    GltfFile::write_text(folder_ / "a%b.png", "png");
    file.json["buffers"] = {{{"byteLength", file.binary.size()}, {"uri", "sub/my%20data.bin"}}};
    file.json["images"] = {{{"uri", "a%25b.png"}}};
    file.json["textures"] = {{{"source", 0}}};
    file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    const Animation film = load_file(file);
    EXPECT_EQ(film.meshes[0].positions[2], glm::vec3(0, 1, 0));
    ASSERT_EQ(film.images.size(), 1u);
    EXPECT_EQ(film.images[0].path.filename(), "a%b.png");
}

TEST_F(Gltf, EmbeddedImagesKeepTheirEncodedBytes) {
    GltfFile file = GltfFile::triangle();
    const int view = file.add_view(std::vector<unsigned char>{1, 2, 3, 4, 5});
    file.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}, {{"uri", "data:image/png;base64,CQgH"}}};
    file.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    file.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}, {"normalTexture", {{"index", 1}, {"scale", 0.5}}}}};
    const Animation film = load_file(file);
    EXPECT_EQ(film.images[static_cast<std::size_t>(film.materials[0].emission_texture.image)].bytes.size(), 5u);
    const ImageSource& normal = film.images[static_cast<std::size_t>(film.materials[0].normal_texture.image)];
    EXPECT_EQ(normal.bytes, (std::vector<std::byte>{std::byte{9}, std::byte{8}, std::byte{7}}));
    EXPECT_EQ(film.materials[0].normal_scale, 0.5f);
}

TEST_F(Gltf, HierarchiesOfMatricesAndTransformsCompose) {
    GltfFile file = GltfFile::triangle();
    file.json["nodes"] = {
        {{"children", {1}}, {"translation", {10, 0, 0}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}},
        {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1}}}};
    const Animation film = load_file(file);
    // (1, 0, 0): doubled and moved to (3, 0, 0), turned to (0, 3, 0), moved.
    const Triangle t = triangle_of(gltf_at(film, 0), 0, 0);
    EXPECT_NEAR(glm::length(t.b - glm::vec3(10, 3, 0)), 0, 1e-5);
}

TEST_F(Gltf, StripsAndFansDrawTheSameQuadAsTriangles) {
    const std::vector<float> quad{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    const auto area_and_side = [&](int mode, const std::vector<std::uint8_t>& indices) {
        GltfFile file = GltfFile::triangle();
        file.primitive()["attributes"]["POSITION"] = file.add_floats(quad, "VEC3");
        file.primitive()["indices"] = file.add_accessor(indices, GltfFile::uint8, "SCALAR");
        file.primitive()["mode"] = mode;
        const Animation film = load_file(file);
        glm::vec3 sum(0);
        for (const glm::uvec3& t : film.meshes[0].triangles) {
            const auto& p = film.meshes[0].positions;
            sum += 0.5f * glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]);
        }
        EXPECT_EQ(film.meshes[0].triangles.size(), 2u);
        return sum;
    };
    EXPECT_EQ(area_and_side(4, {0, 1, 2, 2, 1, 3}), glm::vec3(0, 0, 1));
    EXPECT_EQ(area_and_side(5, {0, 1, 2, 3}), glm::vec3(0, 0, 1));
    EXPECT_EQ(area_and_side(6, {0, 1, 3, 2}), glm::vec3(0, 0, 1));
}

TEST_F(Gltf, PointsAndLinesAreLeftOutAndSaidSo) {
    GltfFile file = GltfFile::triangle();
    nlohmann::json lines = file.primitive();
    lines["mode"] = 1;
    file.json["meshes"][0]["primitives"].push_back(lines);
    const Animation film = load_file(file);
    EXPECT_EQ(film.objects.size(), 1u);
    EXPECT_TRUE(has_note(film, "1 primitive of points or lines"));
}

TEST_F(Gltf, SparseAccessorsReplaceWhatTheirBaseSays) {
    for (const bool has_base : {true, false}) {
        GltfFile file = GltfFile::triangle();
        const int indices = file.add_view(std::vector<std::uint16_t>{1, 2});
        const int values = file.add_view(std::vector<float>{5, 0, 0, 0, 7, 0});
        nlohmann::json& accessor = file.json["accessors"][0];
        accessor["sparse"] = {{"count", 2},
                              {"indices", {{"bufferView", indices}, {"componentType", GltfFile::uint16}}},
                              {"values", {{"bufferView", values}}}};
        if (!has_base) accessor.erase("bufferView");
        const Animation film = load_file(file);
        EXPECT_EQ(film.meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {5, 0, 0}, {0, 7, 0}})) << has_base;
    }
}

TEST_F(Gltf, InterleavedAttributesHonourTheStride) {
    GltfFile file = GltfFile::triangle();
    const int view =
        file.add_view(std::vector<float>{0, 0, 0, 0.1f, 0.2f, 1, 0, 0, 0.3f, 0.4f, 0, 1, 0, 0.5f, 0.6f}, 20);
    const nlohmann::json base = {{"bufferView", view}, {"componentType", 5126}, {"count", 3}};
    nlohmann::json position = base, uv = base;
    position["type"] = "VEC3";
    uv["type"] = "VEC2";
    uv["byteOffset"] = 12;
    file.primitive()["attributes"] = {{"POSITION", file.append("accessors", position)},
                                      {"TEXCOORD_0", file.append("accessors", uv)}};
    const Animation film = load_file(file);
    EXPECT_EQ(film.meshes[0].positions[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(film.meshes[0].uv[0], (std::vector<glm::vec2>{{0.1f, 0.2f}, {0.3f, 0.4f}, {0.5f, 0.6f}}));
}

TEST_F(Gltf, QuantisedMeshesAreMappedAsTheSpecificationSays) {
    GltfFile file = GltfFile::triangle();
    file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    // Positions of plain 16-bit integers with padding to 8 bytes, normals and texture coordinates normalised.
    const int view = file.add_view(std::vector<std::int16_t>{0, 0, 0, 0, 300, 0, 0, 0, 0, -200, 0, 0}, 8);
    const int positions = file.append(
        "accessors", {{"bufferView", view}, {"componentType", GltfFile::int16}, {"count", 3}, {"type", "VEC3"}});
    const int normal_view = file.add_view(std::vector<std::int8_t>{0, 0, -127, 0, 0, 0, -127, 0, 0, 0, -128, 0}, 4);
    const int normals = file.append("accessors", {{"bufferView", normal_view},
                                                  {"componentType", GltfFile::int8},
                                                  {"count", 3},
                                                  {"type", "VEC3"},
                                                  {"normalized", true}});
    const int uv =
        file.add_accessor(std::vector<std::uint16_t>{0, 65535, 32768, 0, 0, 0}, GltfFile::uint16, "VEC2", true);
    file.primitive()["attributes"] = {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uv}};
    const Animation film = load_file(file);
    EXPECT_EQ(film.meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {300, 0, 0}, {0, -200, 0}}));
    for (const glm::vec3& n : film.meshes[0].normals) EXPECT_EQ(n, glm::vec3(0, 0, -1));
    EXPECT_EQ(film.meshes[0].uv[0][0], glm::vec2(0, 1));
    EXPECT_FLOAT_EQ(film.meshes[0].uv[0][1].x, 32768.0f / 65535.0f);
}

TEST_F(Gltf, VertexColoursComeInEveryComponentTypeWithAndWithoutAlpha) {
    const auto colors_of = [&](int accessor, GltfFile& file) {
        file.primitive()["attributes"]["COLOR_0"] = accessor;
        return load_file(file).meshes[0].colors;
    };
    GltfFile a = GltfFile::triangle(), b = GltfFile::triangle(), c = GltfFile::triangle();
    EXPECT_EQ(colors_of(a.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3"), a)[1], glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(colors_of(b.add_accessor(std::vector<std::uint8_t>{255, 0, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0},
                                       GltfFile::uint8, "VEC4", true),
                        b)[0],
              glm::vec4(1, 0, 0, 0.2f));
    EXPECT_EQ(colors_of(c.add_accessor(std::vector<std::uint16_t>{65535, 0, 0, 13107, 0, 0, 0, 0, 0, 0, 0, 0},
                                       GltfFile::uint16, "VEC4", true),
                        c)[0],
              glm::vec4(1, 0, 0, 0.2f));
}

TEST_F(Gltf, OneMeshAtSeveralNodesIsOneMesh) {
    GltfFile file = GltfFile::triangle();
    file.json["nodes"] = {
        {{"mesh", 0}}, {{"mesh", 0}, {"translation", {2, 0, 0}}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}};
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    const Animation film = load_file(file);
    EXPECT_EQ(film.meshes.size(), 1u);
    ASSERT_EQ(film.objects.size(), 3u);
    const Snapshot now = gltf_at(film, 0);
    EXPECT_EQ(triangle_of(now, 1, 0).b, glm::vec3(3, 0, 0));
    EXPECT_EQ(triangle_of(now, 2, 0).b, glm::vec3(-1, 0, 0));
    EXPECT_TRUE(now.objects[2].present);
}

TEST_F(Gltf, PrimitivesKeepOnlyTheVerticesTheyUse) {
    GltfFile file = GltfFile::triangle();
    file.primitive()["attributes"]["POSITION"] = file.add_floats({9, 9, 9, 0, 0, 0, 8, 8, 8, 1, 0, 0, 0, 1, 0}, "VEC3");
    file.primitive()["indices"] = file.add_accessor(std::vector<std::uint32_t>{4, 1, 3}, GltfFile::uint32, "SCALAR");
    const Animation film = load_file(file);
    EXPECT_EQ(film.meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(film.meshes[0].triangles, (std::vector<glm::uvec3>{{2, 0, 1}}));
}

TEST_F(Gltf, OnlyTheDefaultSceneIsShown) {
    GltfFile file = GltfFile::triangle();
    file.json["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
    file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    file.json["scene"] = 1;
    const Animation film = load_file(file);
    ASSERT_EQ(film.objects.size(), 1u);
    EXPECT_EQ(film.objects[0].name, "b");
}

TEST_F(Gltf, AnimationsMoveNodesAndOneCanBeChosen) {
    GltfFile file = GltfFile::triangle();
    const int times = file.add_floats({0, 2}, "SCALAR");
    const auto clip = [&](const char* name, float x) {
        const int values = file.add_floats({0, 0, 0, x, 0, 0}, "VEC3");
        return nlohmann::json{{"name", name},
                              {"samplers", {{{"input", times}, {"output", values}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}};
    };
    file.json["animations"] = {clip("walk", 4), clip("run", 8)};
    const auto x_after_one_second = [&](const LoadOptions& options) {
        return triangle_of(gltf_at(load_file(file, options), 1), 0, 0).a.x;
    };
    EXPECT_EQ(x_after_one_second({}), 2);  // clips of one node: the first
    EXPECT_EQ(x_after_one_second({{}, "run", {}}), 4);
    EXPECT_EQ(x_after_one_second({{}, "0", {}}), 2);
    EXPECT_TRUE(
        has_note(load_file(file),
                 "2 animations move the same nodes; \"walk\" is used; --animation NAME takes another: \"run\""));
    EXPECT_EQ(load_file(file).duration, 2);
    try {
        load_file(file, {{}, "fly", {}});
        FAIL();
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("no animation \"fly\"; there are: 0 \"walk\", 1 \"run\""),
                  std::string::npos)
            << error.what();
    }
}

TEST_F(Gltf, CamerasAreChosenByNameOrIndex) {
    GltfFile file = GltfFile::triangle();
    file.json["cameras"] = {{{"type", "perspective"},
                             {"name", "near"},
                             {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 1.5}}}},
                            {{"type", "orthographic"},
                             {"name", "above"},
                             {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0}, {"zfar", 100}}}}};
    file.json["nodes"] = {{{"mesh", 0}}, {{"camera", 0}, {"translation", {0, 0, 5}}}, {{"camera", 1}}};
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    const Camera first = gltf_at(load_file(file), 0).camera;
    EXPECT_TRUE(first.has_eye());
    EXPECT_EQ(first.position(), glm::vec3(0, 0, 5));
    EXPECT_EQ(first.lens().vertical_fov, 0.5f);
    const Camera by_name = gltf_at(load_file(file, {"above", {}, {}}), 0).camera,
                 by_index = gltf_at(load_file(file, {"1", {}, {}}), 0).camera;
    EXPECT_FALSE(by_name.has_eye());
    EXPECT_EQ(by_name.lens().y_magnification, 3);
    EXPECT_EQ(first.lens().aspect, 1.5f);
    EXPECT_FLOAT_EQ(by_name.lens().aspect, 2.0f / 3);
    EXPECT_FALSE(by_index.has_eye());
    EXPECT_THROW(load_file(file, {"below", {}, {}}), core::Error);
    EXPECT_THROW(load_file(file, {"2", {}, {}}), core::Error);
}

TEST_F(Gltf, SkinsBlendUpToEightJoints) {
    GltfFile file = GltfFile::triangle();
    // Eight joints of equal weight, each moved by its index along x: the mean is 3.5.
    const std::vector<std::uint8_t> first{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3},
        second{4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7};
    nlohmann::json& attributes = file.primitive()["attributes"];
    attributes["JOINTS_0"] = file.add_accessor(first, GltfFile::uint8, "VEC4");
    attributes["JOINTS_1"] = file.add_accessor(second, GltfFile::uint8, "VEC4");
    attributes["WEIGHTS_0"] = file.add_floats(std::vector<float>(12, 0.3f), "VEC4");
    attributes["WEIGHTS_1"] =
        file.add_accessor(std::vector<std::uint8_t>(12, 77), GltfFile::uint8, "VEC4", true);  // 0.302
    nlohmann::json joints = nlohmann::json::array();
    for (int j = 0; j < 8; ++j) joints.push_back(file.append("nodes", {{"translation", {j, 0, 0}}}));
    file.json["skins"] = {{{"joints", joints}}};
    file.json["nodes"][0]["skin"] = 0;
    file.json["nodes"][0]["translation"] = {1000, 0, 0};
    const Animation film = load_file(file);
    const Snapshot now = gltf_at(film, 0);
    EXPECT_EQ(film.objects[0].mobility, Mobility::deforming);
    EXPECT_NEAR(triangle_of(now, 0, 0).a.x, 3.5, 0.02);
    EXPECT_NEAR(triangle_of(now, 0, 0).c.y, 1, 1e-5);
}

TEST_F(Gltf, MorphTargetsFollowNodeWeightsMeshWeightsAndKeys) {
    GltfFile file = GltfFile::triangle();
    const int offsets = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    file.primitive()["targets"] = {{{"POSITION", offsets}}};
    file.json["meshes"][0]["weights"] = {0.5};
    EXPECT_EQ(triangle_of(gltf_at(load_file(file), 0), 0, 0).a.z, 0.5f);
    file.json["nodes"][0]["weights"] = {-0.25};
    EXPECT_EQ(triangle_of(gltf_at(load_file(file), 0), 0, 0).a.z, -0.25f);
    const int times = file.add_floats({0, 1}, "SCALAR"), values = file.add_floats({0, 2}, "SCALAR");
    file.json["animations"] = {{{"samplers", {{{"input", times}, {"output", values}}}},
                                {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    EXPECT_EQ(triangle_of(gltf_at(load_file(file), 0.75), 0, 0).a.z, 1.5f);
}

TEST_F(Gltf, UnknownOptionalExtensionsAreNamedOnce) {
    GltfFile file = GltfFile::triangle();
    file.json["extensionsUsed"] = {"EXT_something", "KHR_materials_unlit", "EXT_something"};
    const Animation film = load_file(file);
    EXPECT_EQ(std::count_if(film.notes.begin(), film.notes.end(),
                            [](const std::string& n) { return n.find("EXT_something") != std::string::npos; }),
              1);
    EXPECT_FALSE(has_note(film, "unlit"));
}

TEST_F(Gltf, AFileWithoutAnythingIsAFilmWithoutAnything) {
    GltfFile file;
    const Animation film = load_file(file);
    EXPECT_TRUE(film.objects.empty());
    EXPECT_EQ(film.cameras.size(), 1u);
    EXPECT_NO_THROW(gltf_at(film, 3));
}

}  // namespace
}  // namespace render2mpeg::scene
