// Meshes that Draco and meshoptimizer compressed.
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "gltf_file.h"
#include "scene/load.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

using test::GltfFile;
using Bytes = std::vector<unsigned char>;

/// A strip of squares in the plane z = 1.
struct Strip {
    std::vector<glm::vec3> positions;
    std::vector<unsigned> corners;

    explicit Strip(unsigned squares) {
        for (unsigned i = 0; i <= squares; ++i)
            for (const float y : {0.0f, 1.0f}) positions.emplace_back(static_cast<float>(i) / 4, y, 1);
        for (unsigned i = 0; i < squares; ++i)
            for (const unsigned k : {0u, 2u, 1u, 1u, 2u, 3u}) corners.push_back(2 * i + k);
    }
};

class GltfCompressed : public ::testing::Test {
  protected:
    Animation loaded(const GltfFile& file) {
        LoadOptions options;
        options.light = DefaultLight::none;
        return load(file.write(folder_ / "film.gltf"), options);
    }
    std::string refusal(const GltfFile& file) {
        try {
            loaded(file);
        } catch (const core::Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "nothing";
    }
    support::Folder folder_;
};

/// Adds a buffer view that holds `count` elements of `stride` bytes, compressed.
int add_packed(GltfFile& file, const Bytes& packed, std::size_t count, std::size_t stride, const std::string& mode,
               const std::string& filter = "NONE") {
    const int view = file.add_view(packed);
    nlohmann::json& json = file.json["bufferViews"][static_cast<std::size_t>(view)];
    json["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                     {"byteOffset", json["byteOffset"]},
                                                     {"byteLength", packed.size()},
                                                     {"count", count},
                                                     {"byteStride", stride},
                                                     {"mode", mode},
                                                     {"filter", filter}};
    json["byteLength"] = count * stride;
    return view;
}

int add_accessor(GltfFile& file, int view, int component, std::size_t count, const std::string& type,
                 bool normalized = false) {
    return file.append("accessors", {{"bufferView", view},
                                     {"componentType", component},
                                     {"count", count},
                                     {"type", type},
                                     {"normalized", normalized}});
}

template <class T>
Bytes packed_vertices(const std::vector<T>& values, std::size_t stride) {
    const std::size_t count = values.size() * sizeof(T) / stride;
    Bytes out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), values.data(), count, stride));
    return out;
}

/// A mesh at one node whose views and accessors are to come.
GltfFile one_mesh() {
    GltfFile file;
    file.append("meshes", {{"primitives", {{{"attributes", nlohmann::json::object()}}}}});
    file.append("nodes", {{"mesh", 0}});
    file.append("scenes", {{"nodes", {0}}});
    return file;
}

/// The strip with normals along z, as meshoptimizer packs it.
GltfFile meshopt_strip(const Strip& strip) {
    GltfFile file = one_mesh();
    const std::size_t n = strip.positions.size();
    const int positions = add_packed(file, packed_vertices(strip.positions, 12), n, 12, "ATTRIBUTES");
    file.primitive()["attributes"]["POSITION"] = add_accessor(file, positions, 5126, n, "VEC3");

    std::vector<float> normals;
    for (std::size_t i = 0; i < n; ++i) normals.insert(normals.end(), {0, 0, 1, 0});
    std::vector<std::int8_t> octahedral(4 * n);
    meshopt_encodeFilterOct(octahedral.data(), n, 4, 8, normals.data());
    const int views = add_packed(file, packed_vertices(octahedral, 4), n, 4, "ATTRIBUTES", "OCTAHEDRAL");
    file.primitive()["attributes"]["NORMAL"] = add_accessor(file, views, 5120, n, "VEC3", true);

    Bytes indices(meshopt_encodeIndexBufferBound(strip.corners.size(), n));
    indices.resize(
        meshopt_encodeIndexBuffer(indices.data(), indices.size(), strip.corners.data(), strip.corners.size()));
    const int corners = add_packed(file, indices, strip.corners.size(), 4, "TRIANGLES");
    file.primitive()["indices"] = add_accessor(file, corners, 5125, strip.corners.size(), "SCALAR");
    return file;
}

TEST_F(GltfCompressed, MeshoptimizersMeshesAreTheOnesThatWerePacked) {
    const Strip strip(20);
    const Animation film = loaded(meshopt_strip(strip));
    ASSERT_EQ(film.meshes.size(), 1u);
    EXPECT_EQ(film.meshes[0].positions, strip.positions);
    EXPECT_EQ(film.meshes[0].triangles.size(), strip.corners.size() / 3);
    for (const glm::vec3& normal : film.meshes[0].normals) EXPECT_GT(normal.z, 0.999f);
}

TEST_F(GltfCompressed, ExponentialAndQuaternionFiltersAreUndone) {
    const Strip strip(20);
    const std::size_t n = strip.positions.size();
    GltfFile file = meshopt_strip(strip);
    std::vector<std::uint32_t> exponential(3 * n);
#if MESHOPTIMIZER_VERSION >= 200
    meshopt_encodeFilterExp(exponential.data(), n, 12, 20, &strip.positions[0].x, meshopt_EncodeExpSharedVector);
#else
    meshopt_encodeFilterExp(exponential.data(), n, 12, 20, &strip.positions[0].x);
#endif
    const int view = add_packed(file, packed_vertices(exponential, 12), n, 12, "ATTRIBUTES", "EXPONENTIAL");
    file.primitive()["attributes"]["POSITION"] = add_accessor(file, view, 5126, n, "VEC3");

    // Copies turned a quarter about z.
    std::vector<float> turns;
    for (int i = 0; i < 2; ++i) turns.insert(turns.end(), {0, 0, 0.70710678f, 0.70710678f});
    std::vector<std::int16_t> packed_turns(8);
    meshopt_encodeFilterQuat(packed_turns.data(), 2, 8, 12, turns.data());
    const int turn = add_packed(file, packed_vertices(packed_turns, 8), 2, 8, "ATTRIBUTES", "QUATERNION");
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] =
        add_accessor(file, turn, 5122, 2, "VEC4", true);
    const Animation film = loaded(file);
    ASSERT_EQ(film.objects.size(), 2u);
    for (std::size_t i = 0; i < n; ++i)
        EXPECT_LT(glm::distance(film.meshes[0].positions[i], strip.positions[i]), 1e-4f);
    const glm::dquat q = film.nodes[static_cast<std::size_t>(film.objects[1].node)].rotation;
    EXPECT_NEAR(std::abs(q.z), 0.7071, 0.002);
}

TEST_F(GltfCompressed, BrokenMeshoptIsRefused) {
    const GltfFile whole = meshopt_strip(Strip(20));
    GltfFile cut = whole;
    auto& extension = cut.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
    extension["byteLength"] = 20;
    EXPECT_NE(refusal(cut).find("does not decode"), std::string::npos);
    extension["count"] = 1e9;
    EXPECT_NE(refusal(cut).find("cannot hold"), std::string::npos);
    GltfFile other = whole;
    other.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "ODD";
    EXPECT_NE(refusal(other).find("ODD"), std::string::npos);
    GltfFile outside = whole;
    outside.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteOffset"] = 1e6;
    EXPECT_NE(refusal(outside).find("leaves its buffer"), std::string::npos);
}

Bytes draco_bytes(const Strip& strip) {
    draco::Mesh mesh;
    const auto n = static_cast<std::uint32_t>(strip.positions.size());
    mesh.set_num_points(n);
    draco::GeometryAttribute place;
    place.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    draco::GeometryAttribute color;
    color.Init(draco::GeometryAttribute::COLOR, nullptr, 4, draco::DT_UINT8, false, 4, 0);
    const int places = mesh.AddAttribute(place, true, n), colors = mesh.AddAttribute(color, true, n);
    const std::array<std::uint8_t, 4> orange{255, 102, 0, 255};
    for (std::uint32_t i = 0; i < n; ++i) {
        mesh.attribute(places)->SetAttributeValue(draco::AttributeValueIndex(i), &strip.positions[i]);
        mesh.attribute(colors)->SetAttributeValue(draco::AttributeValueIndex(i), orange.data());
    }
    for (std::size_t t = 0; t + 2 < strip.corners.size(); t += 3)
        mesh.AddFace({draco::PointIndex(strip.corners[t]), draco::PointIndex(strip.corners[t + 1]),
                      draco::PointIndex(strip.corners[t + 2])});
    draco::Encoder encoder;
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

GltfFile draco_strip(const Bytes& bytes, std::size_t vertices, std::size_t corners) {
    GltfFile file = one_mesh();
    const int view = file.add_view(bytes);
    const int place = file.append("accessors", {{"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}}),
              color = file.append(
                  "accessors", {{"componentType", 5121}, {"count", vertices}, {"type", "VEC4"}, {"normalized", true}}),
              index = file.append("accessors", {{"componentType", 5125}, {"count", corners}, {"type", "SCALAR"}});
    file.primitive()["attributes"] = {{"POSITION", place}, {"COLOR_0", color}};
    file.primitive()["indices"] = index;
    file.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                                    {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
    return file;
}

TEST_F(GltfCompressed, DracosMeshesAreTheOnesThatWerePacked) {
    const Strip strip(20);
    const Animation film = loaded(draco_strip(draco_bytes(strip), strip.positions.size(), strip.corners.size()));
    ASSERT_EQ(film.meshes.size(), 1u);
    const Mesh& mesh = film.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 40u);
    float area = 0;
    for (const glm::uvec3& t : mesh.triangles)
        area += glm::length(
                    glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x])) /
                2;
    EXPECT_NEAR(area, 5, 0.01f);
    for (const glm::vec3& p : mesh.positions) EXPECT_NEAR(p.z, 1, 1e-3f);
    ASSERT_FALSE(mesh.colors.empty());
    EXPECT_NEAR(mesh.colors[3].y, 0.4f, 1e-3f);
}

TEST_F(GltfCompressed, BrokenDracoIsRefused) {
    const Strip strip(20);
    const Bytes whole = draco_bytes(strip);
    EXPECT_NE(refusal(draco_strip(Bytes(whole.begin(), whole.begin() + 30), 42, 120)).find("Draco"), std::string::npos);
    EXPECT_NE(refusal(draco_strip(Bytes(100, 7), 42, 120)).find("Draco"), std::string::npos);
    GltfFile other = draco_strip(whole, 42, 120);
    other.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 9;
    EXPECT_NE(refusal(other).find("no attribute 9"), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg::scene
