#pragma once
// Meshes with skins and morph targets.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// Offsets from the base shape; as many as the mesh has vertices, or empty.
struct MorphTarget {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
};

/// Up to eight joints that move a vertex; weights sum to 1 after validation, unused ones are 0.
struct VertexJoints {
    std::array<std::uint16_t, 8> joint{};  ///< index into Skin::joints
    std::array<float, 8> weight{};
};

/// Triangles or strands of one material in object space; after validation indices are in range, positions finite, areas
/// and radii > 0.
struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;            ///< unit; empty: flat
    std::vector<glm::vec4> tangents;           ///< xyz unit, w = +-1 handedness; empty: derived where needed
    std::array<std::vector<glm::vec2>, 2> uv;  ///< either may be empty
    std::vector<glm::vec4> colors;             ///< linear, multiply the base colour; empty: white
    std::vector<glm::uvec3> triangles;
    std::vector<MorphTarget> morph_targets;
    std::vector<VertexJoints> joints;  ///< empty: not skinned
    /// Instead of triangles: the first of four positions in a row of each segment of a strand (curves.h).
    std::vector<std::uint32_t> curves;
    std::vector<float> radii;  ///< of strands at each position; empty without

    bool has_curves() const { return !curves.empty(); }
    std::size_t primitives() const { return triangles.size() + curves.size(); }
};

/// For each vertex the first one at its place.
std::vector<std::uint32_t> weld(const Mesh& mesh);

}  // namespace render2mpeg::scene
