// glTF 2.0 to an Animation. [glTF2]
#include "scene/gltf/load.h"

#include "scene/gltf/document.h"
#include "scene/gltf/parts.h"

namespace render2mpeg::scene {

Animation load_gltf(const std::filesystem::path& file, const LoadOptions& options,
                    const gltf::BeforeDecoding& before_decoding) {
    const gltf::Document document(file, before_decoding);
    Animation animation;
    animation.source = file.string();
    animation.files = document.files();
    animation.notes = document.notes();
    gltf::read_materials(document, animation);
    gltf::MeshReader meshes(document, gltf::variant_of(document, options, animation), animation);
    const gltf::Carried carried = gltf::read_scene(document, meshes, animation);
    gltf::read_animations(document, options, meshes, carried, animation);
    meshes.add_notes();
    gltf::heed_exporter(document, animation);
    return animation;
}

}  // namespace render2mpeg::scene
