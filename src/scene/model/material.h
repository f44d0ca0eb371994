#pragma once

#include <glm/glm.hpp>
#include <string>

#include "scene/model/image_source.h"

namespace render2mpeg::scene {

enum class AlphaMode { opaque, mask, blend };

/// A surface's look in glTF 2.0's terms [glTF2, 3.9 and appendix B]; every other format is converted to it. Factors are
/// linear; colour textures (base colour, emissive, diffuse, specular) are sRGB, the others linear. Each value is factor
/// x texture.
struct Material {
    std::string name;

    glm::vec4 base_color{1, 1, 1, 1};  ///< reflectance 0..1 and alpha; also the diffuse colour of `specular_glossiness`
    TextureUse base_color_texture;
    float metallic = 0;                     ///< 0..1
    float roughness = 1;                    ///< perceptual, 0..1; GGX's alpha is its square
    TextureUse metallic_roughness_texture;  ///< g: roughness, b: metallic

    /// KHR_materials_pbrSpecularGlossiness: reflectance at normal incidence is given instead of derived.
    bool specular_glossiness = false;
    glm::vec3 specular{1, 1, 1};
    float glossiness = 1;
    TextureUse specular_glossiness_texture;  ///< rgb: specular, a: glossiness

    TextureUse normal_texture;  ///< tangent space, x right, y up, z out
    float normal_scale = 1;

    glm::vec3 emission{0, 0, 0};  ///< radiance, >= 0, KHR_materials_emissive_strength included
    TextureUse emission_texture;

    AlphaMode alpha_mode = AlphaMode::opaque;
    TextureUse alpha_texture;  ///< r: coverage in an image of its own, multiplies base_color's alpha (MTL's map_d); not
                               ///< in glTF
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;  ///< shows base_color as radiance, casts shadows, neither receives nor reflects light

    float transmission = 0;           ///< KHR_materials_transmission, 0..1
    TextureUse transmission_texture;  ///< r
    float ior = 1.5f;                 ///< index of refraction, >= 1

    bool emits() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
};

}  // namespace render2mpeg::scene
