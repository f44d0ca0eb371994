#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf/accessor.h"
#include "scene/gltf/document.h"
#include "scene/model/animation.h"
#include "scene/model/load_options.h"
#include "scene/module/draco.h"

namespace render2mpeg::scene::gltf {

/// Chosen variant of KHR_materials_variants, or -1; notes the others. Throws core::Error for an unknown one.
int variant_of(const Document& document, const LoadOptions& options, Animation& animation);

/// Materials and images in the file's order.
void read_materials(const Document& document, Animation& animation);

/// Default material [glTF2, 3.9.6], added at the first call.
int default_material(Animation& animation);

/// Reads meshes on demand; each primitive becomes one Mesh.
class MeshReader {
  public:
    MeshReader(const Document& document, int variant, Animation& animation)
        : document_(document), variant_(variant), animation_(animation) {}

    struct Part {
        int mesh = -1;      ///< index into Animation::meshes
        int material = -1;  ///< -1: the default one
        std::size_t primitive = 0;
    };
    const std::vector<Part>& parts_of(int mesh);

    std::size_t morph_targets_of(int mesh) const;

    void add_notes();

  private:
    int material_of(const Element& primitive) const;
    const DracoMesh* read_draco(const Element& primitive, const std::map<std::string, int>& attributes);
    std::optional<Mesh> read_primitive(const Element& primitive);
    std::vector<std::uint32_t> read_corners(const Element& primitive, std::size_t vertices) const;
    std::vector<std::uint32_t> read_joint_numbers(int accessor, std::size_t count, const std::string& user);
    void read_joints(const Element& primitive, const std::map<std::string, int>& attributes,
                     const std::vector<std::uint32_t>& used, Mesh& mesh);
    void read_morph_targets(const Element& primitive, const std::vector<std::uint32_t>& used, std::size_t vertices,
                            Mesh& mesh);
    const Floats& floats(int accessor, std::initializer_list<int> components, std::size_t count,
                         const std::string& user);

    const Document& document_;
    int variant_;
    Animation& animation_;
    std::optional<DracoMesh> draco_;      ///< of the primitive that is being read
    std::map<int, Floats> decompressed_;  ///< its attributes, by their accessors
    std::map<int, std::vector<Part>> parts_;
    std::map<int, Floats> decoded_;  ///< per accessor: primitives often share one
    std::size_t undrawn_ = 0;        ///< primitives of points and lines
    std::size_t without_positions_ = 0;
    bool too_many_joints_ = false;
};

/// Target of a KHR_animation_pointer channel.
struct PointedTrack {
    std::optional<TrackTarget> what = {};  ///< none: unknown
    int index = -1;                        ///< node, camera, light of the file, or material
    bool strength = false;                 ///< emission by KHR_materials_emissive_strength, not by emissiveFactor
};

/// Target of a JSON pointer.
PointedTrack pointed_track(const Document& document, const std::string& pointer);

/// Targets of all such channels, in the file's order.
std::vector<PointedTrack> pointed_tracks(const Document& document);

/// The file's camera and light of each of Animation's; several nodes may share one.
struct Carried {
    std::vector<int> cameras, lights;
};

/// Nodes with objects, cameras, lights and skins.
Carried read_scene(const Document& document, MeshReader& meshes, Animation& animation);

/// Keys of all animations, or of the wanted one.
void read_animations(const Document& document, const LoadOptions& options, const MeshReader& meshes,
                     const Carried& carried, Animation& animation);

/// Converts lamps of Blender's exporter to watts, and names boxes that were not ticked.
void heed_exporter(const Document& document, Animation& animation);

}  // namespace render2mpeg::scene::gltf
