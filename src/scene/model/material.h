#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/model/angle_curve.h"
#include "scene/model/hair.h"
#include "scene/model/image_source.h"

namespace render2mpeg::scene {

enum class AlphaMode { opaque, mask, blend };

/// Glass without thickness, a body's boundary, or that where it is closed.
enum class Thickness { thin, solid, solid_where_closed };

/// Whose terms a surface is in: glTF's, or those of the Principled BSDF of Blender 3 and of Blender 4.
enum class SurfaceModel { gltf, principled_3, principled_4 };

/// Light that leaves a surface elsewhere than where it entered, after a random walk.
struct Subsurface {
    float weight = 1;             ///< 0..1, of the Lambert part
    glm::vec3 free_path{0.001f};  ///< mean, by channel, scene units, >= 0
};

/// Surface in glTF 2.0's terms [glTF2, 3.9 and appendix B], or in Blender's by the same names. Factors are linear,
/// colour textures sRGB, others linear; values are factor x texture.
struct Material {
    std::string name;
    SurfaceModel model = SurfaceModel::gltf;

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
    bool holdout = false;   ///< the camera sees a hole in its place, light a surface
    bool seen = true;       ///< false: the camera looks through it, light meets it
    bool mirrored = false;  ///< mirrors and bodies of glass show the emission that alpha hides
    bool unlit = false;     ///< shows base_color as radiance, casts shadows, neither receives nor reflects light

    float transmission = 0;           ///< KHR_materials_transmission, 0..1
    TextureUse transmission_texture;  ///< r
    float ior = 1.5f;                 ///< index of refraction, >= 1

    /// KHR_materials_volume. `Object::body` says which meshes bound a body.
    Thickness thickness = Thickness::thin;
    glm::vec3 attenuation_color{1, 1, 1};  ///< 0..1, transmittance of white light over `attenuation_distance`
    float attenuation_distance = 0;        ///< > 0; 0: infinite, nothing is taken
    float dispersion = 0;                  ///< KHR_materials_dispersion: 20 over Abbe's number, >= 0

    /// KHR_materials_specular: the dielectric reflects this much of what its index says, in this colour.
    float specular_weight = 1;           ///< 0..1
    TextureUse specular_weight_texture;  ///< a
    glm::vec3 specular_tint{1, 1, 1};    ///< >= 0
    TextureUse specular_tint_texture;    ///< sRGB

    /// Blender's models alone.
    float specular_level = 0.5f;   ///< 0..1: F0 is 0.08 x it in Blender 3, that of `ior` x 2 x it in Blender 4
    bool multiscatter = false;     ///< light goes on among a rough lobe's facets
    glm::vec3 gloss{0, 0, 0};      ///< 0..1, of the lobe from all directions (Glossy BSDF)
    float coat_ior = 1.5f;         ///< >= 1
    glm::vec3 coat_tint{1, 1, 1};  ///< 0..1, of light that goes straight through the film and back

    float diffuse_roughness = 0;  ///< 0..1, [Oren1994]'s of a Lambert part; 0: Lambert's

    /// KHR_materials_clearcoat: a clear film of index 1.5 over all else.
    float coat = 0;                     ///< 0..1: how much of the surface it covers
    TextureUse coat_texture;            ///< r
    float coat_roughness = 0;           ///< as `roughness`
    TextureUse coat_roughness_texture;  ///< g

    /// KHR_materials_sheen: fibres that stand off cloth.
    glm::vec3 sheen{0, 0, 0};            ///< 0..1; black: none
    TextureUse sheen_texture;            ///< sRGB
    float sheen_roughness = 0;           ///< 0..1
    TextureUse sheen_roughness_texture;  ///< a

    /// KHR_materials_iridescence: a thin film whose interference colours the reflection.
    float iridescence = 0;                           ///< 0..1
    TextureUse iridescence_texture;                  ///< r
    float film_ior = 1.3f;                           ///< >= 1
    float film_thinnest = 100, film_thickest = 400;  ///< nanometres, where the texture is 0 and 1
    TextureUse film_texture;                         ///< g

    /// KHR_materials_anisotropy: the lobe is wider along a direction of the surface.
    float anisotropy = 0;           ///< 0..1
    float anisotropy_rotation = 0;  ///< of that direction from the tangent, radians, counter-clockwise
    TextureUse anisotropy_texture;  ///< rg: another turn, as a direction; b: strength

    /// KHR_materials_diffuse_transmission: this share of the Lambert part leaves on the other side.
    float diffuse_transmission = 0;                 ///< 0..1
    TextureUse diffuse_transmission_texture;        ///< a
    glm::vec3 diffuse_transmission_color{1, 1, 1};  ///< 0..1
    TextureUse diffuse_transmission_color_texture;  ///< sRGB

    /// Inputs that change with the angle, each at most once. Textures of the other values have the coordinates of the
    /// first ones.
    std::vector<AngleCurve> by_angle;
    TextureUse other_base_color_texture, other_emission_texture;

    std::optional<Hair> hair;
    std::optional<Subsurface> subsurface;

    bool changes_specular() const {
        return specular_weight != 1 || specular_tint != glm::vec3(1) || specular_weight_texture.present() ||
               specular_tint_texture.present();
    }
    /// Null where it is the same from all sides.
    const AngleCurve* curve_of(AngledInput input) const {
        for (const AngleCurve& curve : by_angle)
            if (curve.input == input) return &curve;
        return nullptr;
    }
    bool has_gloss() const { return gloss.x > 0 || gloss.y > 0 || gloss.z > 0; }
    bool has_sheen() const { return sheen.x > 0 || sheen.y > 0 || sheen.z > 0; }
    bool emits() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
};

/// Without roughness, metallic or transmission a surface has no highlight.
inline Material matt(const std::string& name, glm::vec3 color) {
    Material material;
    material.name = name;
    material.base_color = glm::vec4(color, 1);
    material.specular_glossiness = true;
    material.specular = glm::vec3(0);
    material.glossiness = 0;
    return material;
}

struct NamedTexture {
    TextureUse Material::*use;
    const char* name;  ///< for messages
};
inline constexpr NamedTexture texture_uses[] = {
    {&Material::base_color_texture, "base colour texture"},
    {&Material::metallic_roughness_texture, "metallic-roughness texture"},
    {&Material::specular_glossiness_texture, "specular-glossiness texture"},
    {&Material::normal_texture, "normal texture"},
    {&Material::emission_texture, "emission texture"},
    {&Material::alpha_texture, "alpha texture"},
    {&Material::transmission_texture, "transmission texture"},
    {&Material::specular_weight_texture, "specular texture"},
    {&Material::specular_tint_texture, "specular colour texture"},
    {&Material::coat_texture, "clearcoat texture"},
    {&Material::coat_roughness_texture, "clearcoat roughness texture"},
    {&Material::sheen_texture, "sheen colour texture"},
    {&Material::sheen_roughness_texture, "sheen roughness texture"},
    {&Material::iridescence_texture, "iridescence texture"},
    {&Material::film_texture, "thin film's texture"},
    {&Material::anisotropy_texture, "anisotropy texture"},
    {&Material::diffuse_transmission_texture, "diffuse transmission texture"},
    {&Material::diffuse_transmission_color_texture, "diffuse transmission colour texture"},
    {&Material::other_base_color_texture, "other base colour texture"},
    {&Material::other_emission_texture, "other emission texture"},
};

}  // namespace render2mpeg::scene
