#pragma once
// Converts Assimp's structs to ours.
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "scene/assimp/textures.h"
#include "scene/model/animation.h"

struct aiMaterial;
struct aiMesh;
struct aiMeshMorphAnim;
struct aiNodeAnim;
struct aiScene;
template <typename TReal>
class aiMatrix4x4t;
template <typename TReal>
class aiVector3t;

namespace render2mpeg::scene {

/// Throws core::Error where a mesh has wrong indices or coordinates, which Assimp's later steps trust.
void refuse_unsound_meshes(const aiScene& scene, const std::string& file);

glm::dvec3 dvec3_of(const aiVector3t<float>& v);
/// Rows to columns.
glm::dmat4 dmat4_of(const aiMatrix4x4t<float>& m);

/// Corners without joints, in mesh space. Source indices must be in range.
Mesh mesh_from(const aiMesh& source);

/// Reads materials; images of the same name share one entry.
class MaterialReader {
  public:
    /// `format`: lower-case ending, since properties differ by format.
    MaterialReader(const aiScene& scene, const std::filesystem::path& folder, std::string format)
        : scene_(scene), finder_(folder), format_(std::move(format)) {}

    /// Notes missing images and ignored properties.
    Material material_from(const aiMaterial& source, Animation& into);

  private:
    TextureUse texture_from(const aiMaterial& source, int type, Animation& into);
    int image_named(const std::string& written, Animation& into);
    void read_textures(const aiMaterial& source, Material& material, Animation& into);

    const aiScene& scene_;
    TextureFinder finder_;
    std::string format_;
    std::map<std::string, int> image_of_;  ///< -1: not found, and said so
    bool bumps_said_ = false;
};

/// Bones with known nodes, and weights in `mesh`; none, and no weights, without any.
std::optional<Skin> skin_from(const aiMesh& source, const std::unordered_map<std::string, int>& node_named, Mesh& mesh);

/// Tracks of one animated node, keys rising. `ticks_per_second` > 0.
std::vector<Track> tracks_from(const aiNodeAnim& channel, int node, double ticks_per_second);

/// Weights of `targets` morph targets; may have no keys.
Track weights_from(const aiMeshMorphAnim& channel, int node, std::size_t targets, double ticks_per_second);

}  // namespace render2mpeg::scene
