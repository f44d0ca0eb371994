#include "scene/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/text.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

const std::vector<std::string_view> read_extensions = core::words_in(
    "EXT_mesh_gpu_instancing EXT_meshopt_compression EXT_texture_webp KHR_animation_pointer "
    "KHR_draco_mesh_compression KHR_lights_punctual KHR_materials_anisotropy KHR_materials_clearcoat "
    "KHR_materials_diffuse_transmission KHR_materials_dispersion KHR_materials_emissive_strength "
    "KHR_materials_ior KHR_materials_iridescence KHR_materials_pbrSpecularGlossiness KHR_materials_sheen "
    "KHR_materials_specular KHR_materials_transmission KHR_materials_unlit KHR_materials_variants "
    "KHR_materials_volume KHR_mesh_quantization KHR_node_visibility KHR_texture_transform");

struct Meaning {
    std::string_view extension, meaning;
};

constexpr std::array<Meaning, 7> meanings{{
    {"EXT_lights_ies", "lamps shine evenly instead of by their profile"},
    {"EXT_lights_image_based", "its surroundings give no light; --sky can"},
    {"KHR_gaussian_splatting", "splats are not drawn"},
    {"KHR_materials_volume_scatter", "nothing scatters light inside"},
    {"KHR_texture_basisu", "textures in KTX2 are left out where there is no other image"},
    {"KHR_xmp_json_ld", "facts about the file; nothing that is seen"},
    {"MSFT_texture_dds", "textures in DDS are left out where there is no other image"},
}};

}  // namespace

bool is_read(const std::string& extension) {
    return std::find(read_extensions.begin(), read_extensions.end(), extension) != read_extensions.end();
}

std::vector<std::string> extensions_in(const nlohmann::json& file) {
    // No recursion: files may nest deeply.
    std::set<std::string> names;
    std::vector<const nlohmann::json*> pending{&file};
    while (!pending.empty()) {
        const nlohmann::json& value = *pending.back();
        pending.pop_back();
        if (value.is_object()) {
            if (const auto own = value.find("extensions"); own != value.end() && own->is_object())
                for (const auto& [name, content] : own->items()) names.insert(name);
            for (const auto& [key, part] : value.items())
                if (part.is_structured() && key != "extras") pending.push_back(&part);
        } else if (value.is_array()) {
            for (const nlohmann::json& part : value)
                if (part.is_structured()) pending.push_back(&part);
        }
    }
    return {names.begin(), names.end()};
}

std::string not_read(const std::string& extension) {
    const auto known = std::find_if(meanings.begin(), meanings.end(),
                                    [&](const Meaning& meaning) { return meaning.extension == extension; });
    const std::string line = "the optional extension " + in_quotes(extension) + " is not supported; ignored";
    return known == meanings.end() ? line : line + ": " + std::string(known->meaning);
}

}  // namespace render2mpeg::scene::gltf
