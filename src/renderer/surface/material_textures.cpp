#include "renderer/surface/material_textures.h"

#include <map>

namespace render2mpeg::renderer {
namespace {

constexpr std::size_t role_count = static_cast<std::size_t>(TextureRole::count);

bool is_color(TextureRole role) {
    return role == TextureRole::base_color || role == TextureRole::emission ||
           role == TextureRole::specular_glossiness || role == TextureRole::specular_tint ||
           role == TextureRole::sheen || role == TextureRole::diffuse_transmission_color ||
           role == TextureRole::other_base_color || role == TextureRole::other_emission;
}

TextureKey key_of(const scene::Material& material, TextureRole role) {
    const scene::TextureUse& use = use_of(material, role);
    const bool covers = role == TextureRole::base_color && material.alpha_mode != scene::AlphaMode::opaque;
    return {use.image,   is_color(role) ? image::Encoding::srgb : image::Encoding::linear,   use.wrap_u, use.wrap_v,
            use.nearest, covers ? image::AlphaMeaning::coverage : image::AlphaMeaning::value};
}

/// Whether anything looks at the image that a material has in this role.
bool is_looked_at(const scene::Material& material, TextureRole role, const Plan& plan) {
    const bool layered = material.alpha_mode != scene::AlphaMode::opaque;
    switch (role) {
        case TextureRole::alpha:
            return layered && plan.runs(Pass::alpha);
        case TextureRole::metallic_roughness:
            return !material.unlit && !material.specular_glossiness;
        case TextureRole::specular_glossiness:
            return !material.unlit && material.specular_glossiness;
        case TextureRole::normal:
            return !material.unlit && plan.runs(Pass::normal_maps);
        case TextureRole::emission:
        case TextureRole::other_emission:
            return !material.unlit && material.emits();
        case TextureRole::transmission:
            return !material.unlit && material.transmission > 0 && plan.runs(Pass::glass);
        case TextureRole::specular_weight:
        case TextureRole::specular_tint:
            return !material.unlit && !material.specular_glossiness;
        case TextureRole::coat:
        case TextureRole::coat_roughness:
            return !material.unlit && material.coat > 0;
        case TextureRole::sheen:
        case TextureRole::sheen_roughness:
            return !material.unlit && material.has_sheen();
        case TextureRole::iridescence:
        case TextureRole::film:
            return !material.unlit && material.iridescence > 0;
        case TextureRole::anisotropy:
            return !material.unlit && material.anisotropy > 0;
        case TextureRole::diffuse_transmission:
        case TextureRole::diffuse_transmission_color:
            return !material.unlit && material.diffuse_transmission > 0;
        default:
            return true;
    }
}

}  // namespace

const scene::TextureUse& use_of(const scene::Material& material, TextureRole role) {
    switch (role) {
        case TextureRole::alpha:
            return material.alpha_texture;
        case TextureRole::metallic_roughness:
            return material.metallic_roughness_texture;
        case TextureRole::specular_glossiness:
            return material.specular_glossiness_texture;
        case TextureRole::normal:
            return material.normal_texture;
        case TextureRole::emission:
            return material.emission_texture;
        case TextureRole::transmission:
            return material.transmission_texture;
        case TextureRole::specular_weight:
            return material.specular_weight_texture;
        case TextureRole::specular_tint:
            return material.specular_tint_texture;
        case TextureRole::coat:
            return material.coat_texture;
        case TextureRole::coat_roughness:
            return material.coat_roughness_texture;
        case TextureRole::sheen:
            return material.sheen_texture;
        case TextureRole::sheen_roughness:
            return material.sheen_roughness_texture;
        case TextureRole::iridescence:
            return material.iridescence_texture;
        case TextureRole::film:
            return material.film_texture;
        case TextureRole::anisotropy:
            return material.anisotropy_texture;
        case TextureRole::diffuse_transmission:
            return material.diffuse_transmission_texture;
        case TextureRole::diffuse_transmission_color:
            return material.diffuse_transmission_color_texture;
        case TextureRole::other_base_color:
            return material.other_base_color_texture;
        case TextureRole::other_emission:
            return material.other_emission_texture;
        default:
            return material.base_color_texture;
    }
}

MaterialTextures::MaterialTextures(const scene::Animation& animation, const Plan& plan, TextureStore& store)
    : index_(animation.materials.size()) {
    for (auto& roles : index_) roles.fill(-1);
    if (!plan.runs(Pass::textures) && !plan.runs(Pass::normal_maps)) return;

    // Collect what is needed, sorted by image.
    std::vector<char> worn(animation.materials.size(), 0);
    for (const scene::Object& object : animation.objects) worn[static_cast<std::size_t>(object.material)] = 1;
    std::map<TextureKey, int> wanted;
    const auto for_each_use = [&](const auto& body) {
        for (std::size_t m = 0; m < worn.size(); ++m) {
            if (!worn[m]) continue;
            for (std::size_t r = 0; r < role_count; ++r) {
                const scene::Material& material = animation.materials[m];
                const auto role = static_cast<TextureRole>(r);
                if (use_of(material, role).present() && is_looked_at(material, role, plan))
                    body(key_of(material, role), index_[m][r]);
            }
        }
    };
    for_each_use([&](const TextureKey& key, int&) { wanted.emplace(key, 0); });
    std::vector<TextureKey> keys;
    for (auto& [key, position] : wanted) {
        position = static_cast<int>(keys.size());
        keys.push_back(key);
    }
    for_each_use([&](const TextureKey& key, int& index) { index = wanted.at(key); });

    textures_ = store.textures(keys);
}

}  // namespace render2mpeg::renderer
