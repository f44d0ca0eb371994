#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf/document.h"
#include "scene/model/animation.h"
#include "scene/model/load_options.h"
#include "scene/module/draco.h"

/// The parts of a glTF file, each read into an Animation by one file.
namespace render2mpeg::scene::gltf {

/// Index of the wanted one of KHR_materials_variants, -1 for none; tells what there is where nobody chose. Throws
/// core::Error where there is none of that name or number.
int variant_of(const Document& document, const LoadOptions& options, Animation& animation);

/// Materials and the images they use, in the file's order, so that their indices stay.
void read_materials(const Document& document, Animation& animation);

/// The material of primitives that name none [glTF2, 3.9.6]; added at the first call.
int default_material(Animation& animation);

/// Reads meshes as nodes ask for them; primitives that several nodes show become one Mesh.
class MeshReader {
  public:
    /// `variant`: whose materials primitives take; -1: their own.
    MeshReader(const Document& document, int variant, Animation& animation)
        : document_(document), variant_(variant), animation_(animation) {}

    /// One primitive that draws triangles.
    struct Part {
        int mesh = -1;      ///< index into Animation::meshes
        int material = -1;  ///< -1: the default one
        std::size_t primitive = 0;
    };
    const std::vector<Part>& parts_of(int mesh);

    /// Morph targets of a mesh's primitives; all have as many.
    std::size_t morph_targets_of(int mesh) const;

    /// Says what was left out.
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

/// Where a channel of KHR_animation_pointer points.
struct PointedTrack {
    enum class What {
        translation,
        rotation,
        scale,
        weights,
        visibility,
        field_of_view,
        light_intensity,
        light_color,
        base_color,
        emission,           ///< emissiveFactor
        emission_strength,  ///< KHR_materials_emissive_strength
        unknown
    };
    What what = What::unknown;
    int index = -1;  ///< node, camera, light of the file, or material
};

/// What a JSON pointer of KHR_animation_pointer means.
PointedTrack pointed_track(const Document& document, const std::string& pointer);

/// The targets of all channels with the extension, in the file's order.
std::vector<PointedTrack> pointed_tracks(const Document& document);

/// Which camera and light of the file each of Animation's is: several nodes may carry one.
struct Carried {
    std::vector<int> cameras, lights;
};

/// Nodes, and the objects, cameras, lights and skins that the scene's nodes carry.
Carried read_scene(const Document& document, MeshReader& meshes, Animation& animation);

/// Keys of all animations, or of the one that is wanted.
void read_animations(const Document& document, const LoadOptions& options, const MeshReader& meshes,
                     const Carried& carried, Animation& animation);

/// Undoes and says what is known of the program that wrote the file: lamps of Blender's exporter come in watts again,
/// and what it left out is told with the box that was not ticked.
void heed_exporter(const Document& document, Animation& animation);

}  // namespace render2mpeg::scene::gltf
