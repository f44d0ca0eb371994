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

/// One of Assimp's structs to one of ours each; the loader puts them together.
namespace render2mpeg::scene {

/// Assimp's later steps trust indices and sort by coordinates: throws core::Error where a mesh is not sound.
void refuse_unsound_meshes(const aiScene& scene, const std::string& file);

glm::dvec3 dvec3_of(const aiVector3t<float>& v);
/// Rows of Assimp's to columns of ours.
glm::dmat4 dmat4_of(const aiMatrix4x4t<float>& m);

/// Corners, joints aside, in the mesh's own space. Every index of the source must be in range.
Mesh mesh_from(const aiMesh& source);

/// Reads materials, and gives each image that they name one place in `images`.
class MaterialReader {
  public:
    /// `format` is the file's ending in lower case: some formats mean other things by the same property.
    MaterialReader(const aiScene& scene, const std::filesystem::path& folder, std::string format)
        : scene_(scene), finder_(folder), format_(std::move(format)) {}

    /// Notes what is missing or not shown.
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

/// The bones of a mesh whose nodes are known, and the weights in `mesh`; nothing, and no weights, where none is.
std::optional<Skin> skin_from(const aiMesh& source, const std::unordered_map<std::string, int>& node_named, Mesh& mesh);

/// The tracks of one animated node, keys in rising order; what has no key has no track. `ticks_per_second` > 0.
std::vector<Track> tracks_from(const aiNodeAnim& channel, int node, double ticks_per_second);

/// Weights of `targets` morph targets; without keys where the channel has none.
Track weights_from(const aiMeshMorphAnim& channel, int node, std::size_t targets, double ticks_per_second);

}  // namespace render2mpeg::scene
