// Materials, textures and images of a glTF file.
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "core/error.h"
#include "core/plain_file.h"
#include "scene/gltf/parts.h"
#include "scene/gltf/uri.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

core::Wrap wrap_of(const Element& sampler, const char* key) {
    switch (sampler.size(key, 10497)) {
        case 10497:
            return core::Wrap::repeat;
        case 33071:
            return core::Wrap::clamp_to_edge;
        case 33648:
            return core::Wrap::mirrored_repeat;
        default:
            sampler.refuse(std::string(key) + " is none of glTF's");
    }
}

/// uv' = T R S uv with counter-clockwise angles on the image (v down) [KHR_texture_transform]; early drafts' shaders
/// turned the other way, against their own example.
void set_transform(const Element& extension, TextureUse& use) {
    const std::vector<double> offset = extension.numbers("offset", 2), scale = extension.numbers("scale", 2);
    const double rotation = extension.number("rotation", 0);
    const double c = std::cos(rotation), s = std::sin(rotation);
    const double sx = scale.empty() ? 1 : scale[0], sy = scale.empty() ? 1 : scale[1];
    const double matrix[2][3] = {{c * sx, s * sy, offset.empty() ? 0 : offset[0]},
                                 {-s * sx, c * sy, offset.empty() ? 0 : offset[1]}};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column) use.transform[row][column] = static_cast<float>(matrix[row][column]);
}

/// Properties of extensions that are read as they are; defaults are Material's.
template <class Value>
struct Property {
    const char *extension, *key;
    Value Material::*value;
};
constexpr Property<float> factors[] = {
    {"KHR_materials_transmission", "transmissionFactor", &Material::transmission},
    {"KHR_materials_specular", "specularFactor", &Material::specular_weight},
    {"KHR_materials_clearcoat", "clearcoatFactor", &Material::coat},
    {"KHR_materials_clearcoat", "clearcoatRoughnessFactor", &Material::coat_roughness},
    {"KHR_materials_iridescence", "iridescenceFactor", &Material::iridescence},
    {"KHR_materials_iridescence", "iridescenceIor", &Material::film_ior},
    {"KHR_materials_iridescence", "iridescenceThicknessMinimum", &Material::film_thinnest},
    {"KHR_materials_iridescence", "iridescenceThicknessMaximum", &Material::film_thickest},
    {"KHR_materials_anisotropy", "anisotropyStrength", &Material::anisotropy},
    {"KHR_materials_anisotropy", "anisotropyRotation", &Material::anisotropy_rotation},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", &Material::diffuse_transmission},
    {"KHR_materials_sheen", "sheenRoughnessFactor", &Material::sheen_roughness},
    {"KHR_materials_ior", "ior", &Material::ior},
    {"KHR_materials_volume", "attenuationDistance", &Material::attenuation_distance},
    {"KHR_materials_dispersion", "dispersion", &Material::dispersion},
};
constexpr Property<glm::vec3> tints[] = {
    {"KHR_materials_specular", "specularColorFactor", &Material::specular_tint},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorFactor", &Material::diffuse_transmission_color},
    {"KHR_materials_sheen", "sheenColorFactor", &Material::sheen},
    {"KHR_materials_volume", "attenuationColor", &Material::attenuation_color},
};
constexpr Property<TextureUse> textures[] = {
    {"KHR_materials_transmission", "transmissionTexture", &Material::transmission_texture},
    {"KHR_materials_specular", "specularTexture", &Material::specular_weight_texture},
    {"KHR_materials_specular", "specularColorTexture", &Material::specular_tint_texture},
    {"KHR_materials_clearcoat", "clearcoatTexture", &Material::coat_texture},
    {"KHR_materials_clearcoat", "clearcoatRoughnessTexture", &Material::coat_roughness_texture},
    {"KHR_materials_iridescence", "iridescenceTexture", &Material::iridescence_texture},
    {"KHR_materials_iridescence", "iridescenceThicknessTexture", &Material::film_texture},
    {"KHR_materials_anisotropy", "anisotropyTexture", &Material::anisotropy_texture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionTexture", &Material::diffuse_transmission_texture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture",
     &Material::diffuse_transmission_color_texture},
    {"KHR_materials_sheen", "sheenColorTexture", &Material::sheen_texture},
    {"KHR_materials_sheen", "sheenRoughnessTexture", &Material::sheen_roughness_texture},
};

class MaterialReader {
  public:
    MaterialReader(const Document& document, Animation& animation)
        : document_(document), animation_(animation), image_of_(document.count("images"), -1) {}

    void run() {
        for (const Element& element : document_.all("materials")) animation_.materials.push_back(read(element));
    }

  private:
    Material read(const Element& element) {
        Material material;
        material.name = element.string("name", "");
        read_metallic_roughness(element, material);
        if (const auto old = element.extension("KHR_materials_pbrSpecularGlossiness"))
            read_specular_glossiness(*old, material);

        // Occlusion is computed, not read.
        material.normal_texture = texture(element, "normalTexture");
        if (const auto normal = element.object("normalTexture"))
            material.normal_scale = static_cast<float>(normal->number("scale", 1));
        read_emission(element, material);
        read_alpha(element, material);
        material.double_sided = element.boolean("doubleSided", false);
        material.unlit = element.extension("KHR_materials_unlit").has_value();
        read_extensions(element, material);
        // chosen: from here on frosted glass shows no more than colours of what is behind it.
        if (material.transmission > 0 && material.roughness > 0.2f)
            note_once(animation_, "rough glass is seen through as if it were clear");
        const auto coat = element.extension("KHR_materials_clearcoat");
        if (coat && (coat->has("clearcoatNormalTexture") || material.normal_texture.present()))
            note_once(animation_, "clear coats have the normals of what they cover");
        // 0 means reflection without Fresnel: the densest surface is nearest.
        if (material.ior == 0) material.ior = 100;
        // Thickness is for rasterisers.
        const auto volume = element.extension("KHR_materials_volume");
        if (volume && volume->number("thicknessFactor", 0) > 0) material.thickness = Thickness::solid;
        return material;
    }

    void read_extensions(const Element& element, Material& material) {
        for (const auto& [extension, key, value] : factors)
            if (const auto own = element.extension(extension))
                material.*value = static_cast<float>(own->number(key, static_cast<double>(material.*value)));
        for (const auto& [extension, key, value] : tints)
            if (const auto own = element.extension(extension)) set_color(*own, key, material.*value);
        for (const auto& [extension, key, value] : textures)
            if (const auto own = element.extension(extension)) material.*value = texture(*own, key);
    }

    void read_metallic_roughness(const Element& element, Material& material) {
        material.metallic = 1;
        const auto pbr = element.object("pbrMetallicRoughness");
        if (!pbr) return;
        set_color(*pbr, "baseColorFactor", material.base_color);
        material.base_color_texture = texture(*pbr, "baseColorTexture");
        material.metallic = static_cast<float>(pbr->number("metallicFactor", 1));
        material.roughness = static_cast<float>(pbr->number("roughnessFactor", 1));
        material.metallic_roughness_texture = texture(*pbr, "metallicRoughnessTexture");
    }

    void read_specular_glossiness(const Element& extension, Material& material) {
        material.specular_glossiness = true;
        material.metallic = 0;
        material.roughness = 1;
        material.base_color = glm::vec4(1);
        material.metallic_roughness_texture = {};
        set_color(extension, "diffuseFactor", material.base_color);
        material.base_color_texture = texture(extension, "diffuseTexture");
        set_color(extension, "specularFactor", material.specular);
        material.glossiness = static_cast<float>(extension.number("glossinessFactor", 1));
        material.specular_glossiness_texture = texture(extension, "specularGlossinessTexture");
    }

    void read_emission(const Element& element, Material& material) {
        set_color(element, "emissiveFactor", material.emission);
        material.emission_texture = texture(element, "emissiveTexture");
        if (const auto strength = element.extension("KHR_materials_emissive_strength"))
            material.emission *= static_cast<float>(strength->number("emissiveStrength", 1));
    }

    static void read_alpha(const Element& element, Material& material) {
        const std::string mode = element.string("alphaMode", "OPAQUE");
        if (mode == "MASK")
            material.alpha_mode = AlphaMode::mask;
        else if (mode == "BLEND")
            material.alpha_mode = AlphaMode::blend;
        else if (mode != "OPAQUE")
            element.refuse("alphaMode " + in_quotes(mode) + " is none of glTF's");
        material.alpha_cutoff = static_cast<float>(element.number("alphaCutoff", 0.5));
    }

    template <class Color>
    static void set_color(const Element& element, const char* key, Color& color) {
        const std::vector<double> numbers = element.numbers(key, static_cast<std::size_t>(Color::length()));
        for (std::size_t k = 0; k < numbers.size(); ++k) color[static_cast<int>(k)] = static_cast<float>(numbers[k]);
    }

    TextureUse texture(const Element& owner, const char* key) {
        TextureUse use;
        const std::optional<Element> info = owner.object(key);
        if (!info) return use;
        const Element texture = document_.at("textures", info->required_index("index", "textures"));
        std::size_t set = info->size("texCoord", 0);
        if (const auto transform = info->extension("KHR_texture_transform")) {
            set_transform(*transform, use);
            set = transform->size("texCoord", set);
        }
        const std::optional<Element> webp = texture.extension("EXT_texture_webp");
        const int image = webp ? webp->required_index("source", "images") : texture.index("source", "images");
        if (image < 0 || set > 1) {
            const std::string why =
                image < 0 ? "has no image that is understood"
                          : "uses texture coordinates " + std::to_string(set) + "; there are sets 0 and 1";
            note_once(animation_, info->where() + ": " + why + "; left out");
            return TextureUse{};
        }
        use.image = image_source(image);
        use.uv_set = static_cast<int>(set);
        if (const int index = texture.index("sampler", "samplers"); index >= 0) {
            const Element sampler = document_.at("samplers", index);
            use.wrap_u = wrap_of(sampler, "wrapS");
            use.wrap_v = wrap_of(sampler, "wrapT");
            use.nearest = sampler.size("magFilter", 9729) == 9728;
        }
        return use;
    }

    int image_source(int image) {
        int& known = image_of_[static_cast<std::size_t>(image)];
        if (known >= 0) return known;
        const Element element = document_.at("images", image);
        ImageSource source;
        source.name = element.where();
        if (element.has("uri")) {
            const std::string uri = element.string("uri", "");
            try {
                if (auto data = bytes_of_data_uri(uri))
                    source.bytes = std::move(*data);
                else
                    source.path = path_of_uri(uri, document_.folder());
            } catch (const std::invalid_argument& error) {
                element.refuse(error.what());
            }
            std::error_code failure;
            if (!source.path.empty() && !std::filesystem::exists(source.path, failure))
                element.refuse("there is no file " + in_quotes(source.path.string()));
            if (const std::string why = core::why_no_plain_file(source.path); !source.path.empty() && !why.empty())
                element.refuse(in_quotes(source.path.string()) + ": " + why);
        } else {
            const Document::Bytes bytes =
                document_.view(element.required_index("bufferView", "bufferViews"), element.where());
            source.bytes.assign(bytes.first, bytes.first + bytes.size);
        }
        if (source.path.empty() && source.bytes.empty()) element.refuse("is empty");
        known = static_cast<int>(animation_.images.size());
        animation_.images.push_back(std::move(source));
        return known;
    }

    const Document& document_;
    Animation& animation_;
    std::vector<int> image_of_;
};

}  // namespace

void read_materials(const Document& document, Animation& animation) {
    MaterialReader(document, animation).run();
}

int default_material(Animation& animation) {
    static constexpr const char* name = "(default)";
    const int last = static_cast<int>(animation.materials.size()) - 1;
    if (last >= 0 && animation.materials.back().name == name) return last;
    Material material;
    material.name = name;
    material.metallic = 1;
    animation.materials.push_back(material);
    return last + 1;
}

}  // namespace render2mpeg::scene::gltf
