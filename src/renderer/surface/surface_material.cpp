#include "renderer/surface/surface_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "renderer/surface/dielectric.h"
#include "renderer/surface/lobe_albedo.h"
#include "renderer/surface/principled.h"
#include "renderer/surface/shading_normal.h"
#include "renderer/surface/sheen.h"
#include "renderer/surface/thin_film.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

using Input = scene::AngledInput;

float largest(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}
glm::vec3 unit_range(glm::vec3 v) {
    return glm::clamp(v, glm::vec3{0.0f}, glm::vec3{1.0f});
}

/// Reflectance at normal incidence of an interface [glTF2, appendix B]; 0 for index 1, which is no interface.
float f0_of(float ior) {
    const float r = (ior - 1.0f) / (ior + 1.0f);
    return r * r;
}

/// Schlick's Fresnel term [Schlick1994, eq. 15], per channel; without reflectance at normal incidence there is none at
/// all.
glm::vec3 fresnel(glm::vec3 f0, float cosine, glm::vec3 f90 = glm::vec3{1.0f}) {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    const float m5 = m * m * m * m * m;
    glm::vec3 f;
    for (int c = 0; c < 3; ++c) f[c] = f0[c] > 0.0f ? f0[c] + (f90[c] - f0[c]) * m5 : 0.0f;
    return f;
}

/// Share of light that passes glass which it meets with this cosine [KHR_materials_transmission].
glm::vec3 passing_glass(glm::vec3 color, float metallic, float transmission, glm::vec3 f0, float f90, float cosine) {
    return color * ((1.0f - metallic) * transmission) * (1.0f - fresnel(f0, cosine, glm::vec3{f90}));
}

/// Colour of light that passes one surface of glass. Blender 4 means its base colour for both.
glm::vec3 glass_color(const scene::Material& m, glm::vec3 base_color) {
    return m.model == scene::SurfaceModel::principled_4 ? glm::sqrt(base_color) : base_color;
}

/// A surface whose share `metal` reflects `metal_f0` at normal incidence and has nothing below; `coat`: what the
/// interface of the rest reflects.
struct Interface {
    float coat = 0, metal = 0;
    glm::vec3 metal_f0{0};
    float coat_f90 = 1;

    /// Share of what the interface lets pass, over that of one that mirrors all at grazing angles; `passes`: its share
    /// of even light.
    float let_through(float passes) const {
        if (coat_f90 == 1.0f) return 1.0f - coat;
        return (1.0f - coat - (coat_f90 - coat) * (1.0f - passes)) / passes;
    }
};

/// Makes the GGX lobe of `bsdf.f0` whole and lays the Lambert part below it [glTF2, appendix B].
void lay_below_lobe(Bsdf& bsdf, const Interface& surface, float cosine) {
    // Light lost to facets' mutual shadowing leaves metal after more reflections [Turquin2019]; elsewhere most of it
    // goes below. chosen: no more than a hundredth of that, so that glTF's formula is kept so exactly.
    constexpr float most_regain = 1.01f;
    const LobeAlbedo lobe = lobe_albedo(cosine, bsdf.mean_alpha());
    const glm::vec3 regained = surface.metal * (core::divide_or(1.0f, lobe.whole(), 1.0f) - 1.0f) * surface.metal_f0;
    bsdf.f90 += regained;
    bsdf.f0 += surface.metal_f0 * regained;
    const float passes = 1.0f - mean_schlick(cosine);
    const float through = surface.let_through(passes);
    const float below =
        core::divide_or(1.0f - surface.coat * lobe.f0 - surface.coat_f90 * lobe.f90, through * passes, 1.0f);
    // glTF's mixing alone reflects more than it receives of bright colours at grazing angles.
    const glm::vec3 rest = 1.0f - lobe.f0 * bsdf.f0 - lobe.f90 * bsdf.f90 - bsdf.transmission;
    bsdf.diffuse = glm::min(through * std::clamp(below, 1.0f, most_regain) * bsdf.diffuse,
                            glm::max(rest, glm::vec3{0.0f}) / passes);
}

/// Lays the Lambert part below a mirror: as below a lobe, but for even light only, so that it stays a Lambert part.
void lay_below_mirror(Bsdf& bsdf, const Interface& surface, float cosine) {
    const float even = 1.0f - mean_schlick(cosine);
    const float passes = surface.let_through(even) * even;
    bsdf.diffuse = glm::min(passes * bsdf.diffuse, glm::max(1.0f - bsdf.mirror - bsdf.transmission, glm::vec3{0.0f}));
}

/// Parts the Lambert reflectance of `bsdf`, made for the mixture of both colours, among the two sides.
void part_sides(Bsdf& bsdf, glm::vec3 base_color, float share, glm::vec3 color, float cosine) {
    const float passes = bsdf.has_lobe() ? 1.0f - bsdf.covered * mean_schlick(cosine) : 1.0f;
    const glm::vec3 mixed = glm::mix(base_color, color, share);
    for (int c = 0; c < 3; ++c) {
        const float through = bsdf.diffuse[c] * core::divide_or(share * color[c], mixed[c], 0.0f);
        bsdf.diffuse_transmission[c] = passes * through;
        bsdf.diffuse[c] = std::max(bsdf.diffuse[c] - through, 0.0f);
    }
}

/// The boundary of a body of glass reflects as exactly as its media say [BornWolf, 1.5.2]; `transmission` comes without
/// that. Rough ones reflect by their lobe from outside, by traced rays from inside, where no lamp reaches.
void bound_body(Bsdf& bsdf, const Interface& surface, float index, float cos_outgoing, bool traced) {
    const float clear = dielectric_reflectance(cos_outgoing, index);
    const float reflected = clear < 1.0f ? clear * surface.coat_f90 : 1.0f;
    bsdf.ior = index;
    bsdf.transmission *= 1.0f - reflected;
    if (!traced && index > 1.0f) {
        lay_below_lobe(bsdf, surface, cos_outgoing);
        return;
    }
    bsdf.mirror = (1.0f - surface.metal) * reflected + surface.metal * fresnel(surface.metal_f0, cos_outgoing);
    bsdf.f0 = glm::vec3{0.0f};
    bsdf.diffuse =
        glm::min((1.0f - reflected) * bsdf.diffuse, glm::max(1.0f - bsdf.mirror - bsdf.transmission, glm::vec3{0.0f}));
}

}  // namespace

SurfaceMaterials::SurfaceMaterials(const scene::Animation& animation, const Plan& plan, TextureStore& store)
    : animation_(animation),
      alpha_(plan.runs(Pass::alpha)),
      mirrors_(plan.runs(Pass::mirrors)),
      glass_(plan.runs(Pass::glass)),
      glossy_(plan.runs(Pass::glossy)),
      hair_(plan.runs(Pass::hair)),
      subsurface_(plan.runs(Pass::subsurface)),
      textures_(animation, plan, store) {}

glm::vec4 SurfaceMaterials::look_up(std::uint32_t material, TextureRole role, const SurfaceShape& shape) const {
    const image::Texture* texture = textures_.of(material, role);
    if (texture == nullptr) return glm::vec4{1.0f};
    const TextureSite site = site_of(shape, use_of(animation_.materials[material], role));
    return texture->sample(site.uv, site.footprint);
}

/// An input as it is seen from a direction; without a cosine from all.
glm::vec3 SurfaceMaterials::seen(std::uint32_t material, scene::AngledInput input, glm::vec3 value,
                                 const SurfaceShape& shape, std::optional<float> cosine) const {
    const scene::AngleCurve* curve = animation_.materials[material].curve_of(input);
    if (curve == nullptr) return value;
    glm::vec3 other = curve->other;
    if (input == scene::AngledInput::base_color)
        other *= glm::vec3(vertex_color(shape) * look_up(material, TextureRole::other_base_color, shape));
    if (input == scene::AngledInput::emission)
        other *= glm::vec3(look_up(material, TextureRole::other_emission, shape));
    return glm::mix(value, other, cosine ? curve->share_at(*cosine) : curve->mean_share());
}

float SurfaceMaterials::seen(std::uint32_t material, scene::AngledInput input, float value, float cosine) const {
    const scene::AngleCurve* curve = animation_.materials[material].curve_of(input);
    return curve == nullptr ? value : std::lerp(value, curve->other.x, curve->share_at(cosine).x);
}

float SurfaceMaterials::metallic_at(std::uint32_t material, glm::vec4 texel, float cosine) const {
    const float own = animation_.materials[material].metallic * texel.b;
    return std::clamp(seen(material, scene::AngledInput::metallic, own, cosine), 0.0f, 1.0f);
}

glm::vec4 SurfaceMaterials::base_color_at(std::uint32_t material, const SurfaceShape& shape,
                                          const scene::Snapshot& snapshot, float cosine) const {
    const glm::vec4 own =
        snapshot.base_color[material] * vertex_color(shape) * look_up(material, TextureRole::base_color, shape);
    return {seen(material, scene::AngledInput::base_color, glm::vec3(own), shape, cosine),
            seen(material, scene::AngledInput::alpha, own.a, cosine)};
}

float SurfaceMaterials::coverage(std::uint32_t material, const SurfaceShape& shape, float base_alpha) const {
    const scene::Material& m = animation_.materials[material];
    if (!alpha_ || m.alpha_mode == scene::AlphaMode::opaque) return 1.0f;
    const float alpha = base_alpha * look_up(material, TextureRole::alpha, shape).r;
    if (m.alpha_mode == scene::AlphaMode::mask) return alpha >= m.alpha_cutoff ? 1.0f : 0.0f;
    return std::clamp(alpha, 0.0f, 1.0f);
}

float SurfaceMaterials::transmission_at(std::uint32_t material, const SurfaceShape& shape, float cosine) const {
    const float factor = animation_.materials[material].transmission;
    if (!glass_ || !(factor > 0.0f)) return 0.0f;
    const float own = factor * look_up(material, TextureRole::transmission, shape).r;
    return std::clamp(seen(material, scene::AngledInput::transmission, own, cosine), 0.0f, 1.0f);
}

bool SurfaceMaterials::is_translucent(std::uint32_t material) const {
    const scene::Material& m = animation_.materials[material];
    if (glass_ && m.transmission > 0.0f && !m.unlit) return true;
    if (!alpha_ || m.alpha_mode == scene::AlphaMode::opaque) return false;
    // Without an image only the factor and the vertices can make holes.
    if (m.base_color_texture.present() || m.alpha_texture.present()) return true;
    if (m.curve_of(scene::AngledInput::alpha) != nullptr) return true;
    const float full = m.alpha_mode == scene::AlphaMode::mask ? m.alpha_cutoff : 1.0f;
    if (m.base_color.a < full || scene::is_faded(animation_, material)) return true;
    for (const scene::Object& object : animation_.objects) {
        const auto mesh = static_cast<std::size_t>(object.mesh);
        if (object.material == static_cast<int>(material) && !animation_.meshes[mesh].colors.empty()) return true;
    }
    return false;
}

bool SurfaceMaterials::is_cut_out(std::uint32_t material) const {
    const scene::Material& m = animation_.materials[material];
    return alpha_ && m.alpha_mode != scene::AlphaMode::opaque && m.transmission == 0.0f &&
           m.curve_of(Input::alpha) == nullptr && !scene::is_faded(animation_, material) &&
           (textures_.of(material, TextureRole::base_color) != nullptr ||
            textures_.of(material, TextureRole::alpha) != nullptr);
}

glm::vec3 SurfaceMaterials::emission_at(std::uint32_t material, const SurfaceShape& shape,
                                        std::optional<float> cosine) const {
    const scene::Material& m = animation_.materials[material];
    if (m.unlit || !m.emits()) return glm::vec3{0.0f};
    return seen(material, scene::AngledInput::emission,
                m.emission * glm::vec3(look_up(material, TextureRole::emission, shape)), shape, cosine);
}

glm::vec3 SurfaceMaterials::transmittance_at(std::uint32_t material, const SurfaceShape& shape,
                                             const scene::Snapshot& snapshot, float cosine, const Medium* pane,
                                             float thickness) const {
    const scene::Material& m = animation_.materials[material];
    const glm::vec4 base = base_color_at(material, shape, snapshot, cosine);
    const float covered = coverage(material, shape, base.a);
    const glm::vec3 holes{1.0f - covered};
    if (m.unlit || covered <= 0.0f) return holes;
    const float transmission = transmission_at(material, shape, cosine);
    if (!(transmission > 0.0f) || m.specular_glossiness) return holes;
    const float metallic = metallic_at(material, look_up(material, TextureRole::metallic_roughness, shape), cosine);
    const Dielectric interface = dielectric_at(material, shape);
    const glm::vec3 color = glass_color(m, unit_range(glm::vec3(base)));
    if (pane == nullptr)
        return holes + covered * passing_glass(color, metallic, transmission, interface.f0, interface.f90, cosine);
    const float reflected = dielectric_reflectance(cosine, pane->index) * interface.f90;
    return holes +
           covered * color * ((1.0f - metallic) * transmission) * passing_pane(*pane, reflected, cosine, thickness);
}

void SurfaceMaterials::fill(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object, float index,
                            Holes holes) const {
    Detail detail;
    bend_normal(point, shape, object, detail.normal_variance);
    reflect(point, shape, object, index, holes, detail);
    if (!point.bsdf.shows_things()) return;
    const glm::vec3 turned = turned_to_mirror(point.shading_normal, point.geometric_normal, point.outgoing);
    if (turned == point.shading_normal) return;
    point.shading_normal = turned;
    reflect(point, shape, object, index, holes, detail);
}

/// All but normals, as seen at the shading normal.
void SurfaceMaterials::reflect(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object, float index,
                               Holes holes, Detail detail) const {
    const std::uint32_t material = point.material;
    const scene::Material& m = animation_.materials[material];
    const float cosine = glm::dot(point.shading_normal, point.outgoing);
    const glm::vec4 base = base_color_at(material, shape, object.snapshot(), cosine);
    point.alpha = coverage(material, shape, base.a);
    point.unlit = m.unlit;
    if (holes == Holes::bare && point.alpha == 0.0f && !m.unlit && !m.emits()) return;
    if (m.unlit) {
        point.emission = glm::max(glm::vec3(base), glm::vec3{0.0f});
        return;
    }
    if (!point.back_side || m.double_sided)
        point.emission = object.snapshot().emission_factor[material] * emission_at(material, shape, cosine);
    point.fibre = hair_ && m.hair && shape.mesh->has_curves();
    if (point.fibre) return;
    const glm::vec3 color = unit_range(glm::vec3(base));
    if (m.diffuse_transmission > 0.0f && !m.specular_glossiness) detail.leaf = leaf_at(material, shape);
    if (m.anisotropy > 0.0f) brush(point, shape, object, detail);
    point.bsdf = bsdf_at(material, shape, color, cosine, detail, index);
    if (m.diffuse_roughness > 0.0f) roughen(m, color, cosine, point.bsdf);
    if (!point.bsdf.has_lobe() && !point.bsdf.shape.is_lambert()) point.bsdf.alpha = 1.0f;
    if (detail.leaf.share > 0.0f) part_sides(point.bsdf, color, detail.leaf.share, detail.leaf.color, cosine);
    if (m.has_sheen()) add_sheen(material, shape, cosine, point.bsdf);
    point.spreads = subsurface_ && m.subsurface && point.bsdf.has_diffuse() && !shape.mesh->has_curves();
    if (point.spreads) point.bsdf.shape = {};
    if (m.coat > 0.0f) add_coat(material, shape, cosine, point.bsdf);
    if (m.model != scene::SurfaceModel::gltf) keep_energy(point.bsdf, cosine);
    // What neither part reflects needs no light, whatever shape it would have: a mirror of Blender's is left.
    if (!point.bsdf.has_diffuse() && !point.bsdf.has_lobe()) point.bsdf.shape = {};
}

/// Applies the normal map, and turns everything to the viewer. `variance`: of the map's slopes within the footprint.
void SurfaceMaterials::bend_normal(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object,
                                   float& variance) const {
    glm::vec3 normal = shape.smooth_normal;
    const scene::Material& m = animation_.materials[point.material];
    glm::vec3 right, up;
    if (const image::Texture* map = textures_.of(point.material, TextureRole::normal);
        map != nullptr && tangents_of(object, shape, m.normal_texture, right, up)) {
        const TextureSite site = site_of(shape, m.normal_texture);
        const glm::vec3 mean = 2.0f * glm::vec3(map->sample(site.uv, site.footprint)) - 1.0f;
        const glm::vec3 bent = m.normal_scale * (mean.x * right + mean.y * up) + mean.z * normal;
        normal = core::normalize_or(bent, normal);
        // Averaged normals are short where they disagree: what the pixel cannot resolve becomes roughness [Toksvig2005,
        // eq. 2]. chosen: the first 1 % is the rounding of 8-bit maps, whose normals are up to that much too short.
        const float length = std::clamp(glm::length(mean), 0.1f, 1.0f);
        variance = std::max(0.0f, (1.0f - length) / length - 0.01f) * m.normal_scale * m.normal_scale;
    }
    point.shading_normal = turned_to_viewer(point.back_side ? -normal : normal, point.geometric_normal, point.outgoing);
}

SurfaceMaterials::Dielectric SurfaceMaterials::dielectric_at(std::uint32_t material, const SurfaceShape& shape) const {
    const scene::Material& m = animation_.materials[material];
    Dielectric interface { glm::vec3{f0_of(m.ior)}, 1.0f };
    if (!m.changes_specular()) return interface;
    const glm::vec3 tint = m.specular_tint * glm::vec3(look_up(material, TextureRole::specular_tint, shape));
    interface.f90 =
        std::clamp(m.specular_weight * look_up(material, TextureRole::specular_weight, shape).a, 0.0f, 1.0f);
    interface.f0 = interface.f90 * unit_range(interface.f0 * tint);
    return interface;
}

/// Reflectance at normal incidence of what reflects `f0` there without its thin film, as the eye sees it from here.
glm::vec3 SurfaceMaterials::film_over(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing,
                                      glm::vec3 f0) const {
    const scene::Material& m = animation_.materials[material];
    const float share = std::clamp(m.iridescence * look_up(material, TextureRole::iridescence, shape).r, 0.0f, 1.0f);
    const float thickness = std::lerp(m.film_thinnest, m.film_thickest, look_up(material, TextureRole::film, shape).g);
    const float cosine = std::clamp(cos_outgoing, 0.0f, 1.0f);
    return glm::mix(f0, schlick_f0(thin_film(m.film_ior, thickness, cosine, f0), cosine), share);
}

/// Where the surface is brushed, and how much [KHR_materials_anisotropy]; without texture coordinates not at all.
void SurfaceMaterials::brush(const SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object,
                             Detail& detail) const {
    const scene::Material& m = animation_.materials[point.material];
    const scene::TextureUse& use = m.anisotropy_texture.present() ? m.anisotropy_texture : m.normal_texture;
    glm::vec3 right, up;
    if (!tangents_of(object, shape, use, right, up)) return;
    const glm::vec4 texel = m.anisotropy_texture.present() ? look_up(point.material, TextureRole::anisotropy, shape)
                                                           : glm::vec4(1.0f, 0.5f, 1.0f, 1.0f);
    const glm::vec2 own = 2.0f * glm::vec2(texel) - 1.0f;
    const float c = std::cos(m.anisotropy_rotation), s = std::sin(m.anisotropy_rotation);
    const glm::vec2 turned(c * own.x - s * own.y, s * own.x + c * own.y);
    const glm::vec3 n = point.shading_normal, along = turned.x * right + turned.y * up;
    detail.along = core::normalize_or(along - glm::dot(along, n) * n, glm::vec3{0.0f});
    if (detail.along != glm::vec3{0.0f}) detail.anisotropy = std::clamp(m.anisotropy * texel.b, 0.0f, 1.0f);
}

SurfaceMaterials::Leaf SurfaceMaterials::leaf_at(std::uint32_t material, const SurfaceShape& shape) const {
    const scene::Material& m = animation_.materials[material];
    return {
        std::clamp(m.diffuse_transmission * look_up(material, TextureRole::diffuse_transmission, shape).a, 0.0f, 1.0f),
        unit_range(m.diffuse_transmission_color *
                   glm::vec3(look_up(material, TextureRole::diffuse_transmission_color, shape)))};
}

/// Fibres send light like a Lambert surface whose reflectance rises towards grazing angles, and take it from below
/// [KHR_materials_sheen, "Albedo-Scaling"].
void SurfaceMaterials::add_sheen(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing,
                                 Bsdf& bsdf) const {
    const scene::Material& m = animation_.materials[material];
    const glm::vec3 color = unit_range(m.sheen * glm::vec3(look_up(material, TextureRole::sheen, shape)));
    const float roughness = m.sheen_roughness * look_up(material, TextureRole::sheen_roughness, shape).a;
    if (m.model == scene::SurfaceModel::principled_3) {
        // Schlick's term of the half vector, per steradian, upon all else. [Burley2012, 5.4]
        const float albedo = std::numbers::pi_v<float> * mean_schlick(cos_outgoing);
        bsdf.diffuse += color * (albedo / diffuse_share(bsdf, cos_outgoing));
        return;
    }
    const float albedo = m.model == scene::SurfaceModel::principled_4
                             ? microfibre_albedo(cos_outgoing, roughness)
                             : std::min(sheen_albedo(cos_outgoing, roughness), 1.0f);
    const float below = 1.0f - largest(color) * albedo;
    bsdf.scale(below);
    bsdf.diffuse += color * (albedo / diffuse_share(bsdf, cos_outgoing));
}

/// A clear film of index 1.5 [KHR_materials_clearcoat]. A smooth one mirrors; a rough one takes the place of the lobe
/// of a dielectric below, whose own light then goes with the Lambert part. Over metal's lobe any film mirrors.
void SurfaceMaterials::add_coat(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing,
                                Bsdf& bsdf) const {
    const scene::Material& m = animation_.materials[material];
    const float own = m.coat * look_up(material, TextureRole::coat, shape).r;
    const float share = std::clamp(seen(material, scene::AngledInput::coat, own, cos_outgoing), 0.0f, 1.0f);
    const float roughness =
        std::clamp(m.coat_roughness * look_up(material, TextureRole::coat_roughness, shape).g, 0.0f, 1.0f);
    constexpr float f0 = 0.04f;
    if (!(share > 0.0f)) return;
    if (m.model != scene::SurfaceModel::gltf) {
        lay_coat(m, {share, roughness, cos_outgoing, mirrors_, glossy_}, bsdf);
        return;
    }
    const float reflected = share * fresnel(glm::vec3{f0}, cos_outgoing).x;
    bsdf.scale(1.0f - reflected);
    if (roughness < scene::mirror_roughness || largest(bsdf.f0) > most_of_dielectrics) {
        if (mirrors_) bsdf.mirror += reflected;
        return;
    }
    if (!glossy_) return;
    const float passes = 1.0f - mean_schlick(cos_outgoing);
    if (bsdf.has_lobe())
        bsdf.diffuse += glossy_albedo(bsdf, cos_outgoing) / passes;
    else
        bsdf.diffuse /= passes;
    bsdf.diffuse = glm::min(bsdf.diffuse, glm::vec3{1.0f});
    bsdf.f0 = glm::vec3{share * f0};
    bsdf.f90 = glm::vec3{share};
    bsdf.alpha = roughness * roughness;
    bsdf.along = glm::vec3{0.0f};
}

void SurfaceMaterials::stretch(const Detail& detail, Bsdf& bsdf) {
    bsdf.alpha_along = std::lerp(bsdf.alpha, 1.0f, detail.anisotropy * detail.anisotropy);
    bsdf.along = detail.along;
}

/// Blender's models: diffuse part, lobe or mirror; transmission, width and direction are set.
void SurfaceMaterials::reflect_as_blender(std::uint32_t material, const SurfaceShape& shape, glm::vec3 base_color,
                                          float roughness, float cosine, Bsdf& bsdf) const {
    const scene::Material& m = animation_.materials[material];
    PrincipledInputs in;
    in.model = m.model;
    in.base = base_color;
    in.metallic = metallic_at(material, look_up(material, TextureRole::metallic_roughness, shape), cosine);
    in.roughness = roughness;
    in.transmission = transmission_at(material, shape, cosine);
    const float level = m.specular_level * look_up(material, TextureRole::specular_weight, shape).a;
    in.glass_f0 = f0_of(m.ior);
    in.specular_f0 =
        m.model == scene::SurfaceModel::principled_3 ? 0.08f * level : std::min(2.0f * level * f0_of(m.ior), 1.0f);
    in.tint = m.specular_tint * glm::vec3(look_up(material, TextureRole::specular_tint, shape));
    in.gloss = seen(material, scene::AngledInput::gloss, m.gloss, shape, cosine);
    in.multiscatter = m.multiscatter;
    in.cosine = cosine;
    in.smooth = mirrors_ && roughness < scene::mirror_roughness && !bsdf.is_stretched();
    if (m.iridescence > 0.0f) {
        const glm::vec3 film = film_over(material, shape, cosine, glm::vec3(in.specular_f0));
        in.tint *= film / std::max(in.specular_f0, 1e-6f);
    }
    reflect_as_principled(in, bsdf);
    if (!glossy_) bsdf.f0 = bsdf.f90 = glm::vec3{0.0f};
}

Bsdf SurfaceMaterials::bsdf_at(std::uint32_t material, const SurfaceShape& shape, glm::vec3 base_color,
                               float cos_outgoing, const Detail& detail, float index) const {
    const scene::Material& m = animation_.materials[material];
    Bsdf bsdf;
    float roughness = 1.0f;
    Interface surface;
    bsdf.ior = m.ior;
    if (m.specular_glossiness) {
        const glm::vec4 texel = look_up(material, TextureRole::specular_glossiness, shape);
        bsdf.f0 = unit_range(m.specular * glm::vec3(texel));
        roughness = 1.0f - std::clamp(m.glossiness * texel.a, 0.0f, 1.0f);
        bsdf.diffuse = base_color;
        surface = {largest(bsdf.f0), 1.0f - largest(base_color), bsdf.f0};
    } else {
        // Mix metal and dielectric; transmission takes the place of the dielectric's diffuse part
        // [KHR_materials_transmission].
        const glm::vec4 texel = look_up(material, TextureRole::metallic_roughness, shape);
        const float metallic = metallic_at(material, texel, cos_outgoing);
        const float transmission = transmission_at(material, shape, cos_outgoing);
        const Dielectric interface = dielectric_at(material, shape);
        surface = {largest(interface.f0), metallic, base_color, interface.f90};
        roughness = std::clamp(seen(material, Input::roughness, m.roughness * texel.g, cos_outgoing), 0.0f, 1.0f);
        bsdf.f0 = glm::mix(interface.f0, base_color, metallic);
        bsdf.f90 = glm::vec3{1.0f - (1.0f - metallic) * (1.0f - interface.f90)};
        bsdf.diffuse =
            glm::mix(base_color, detail.leaf.color, detail.leaf.share) * ((1.0f - metallic) * (1.0f - transmission));
        bsdf.transmission = index > 0.0f ? glass_color(m, base_color) * ((1.0f - metallic) * transmission)
                                         : passing_glass(glass_color(m, base_color), metallic, transmission,
                                                         interface.f0, interface.f90, cos_outgoing);
    }
    const bool smooth = roughness < scene::mirror_roughness;
    const float alpha = std::pow(std::max(roughness, scene::mirror_roughness), 2.0f);
    bsdf.alpha = std::min(std::sqrt(alpha * alpha + 2.0f * detail.normal_variance), 1.0f);
    if (index > 0.0f) {
        bound_body(bsdf, surface, index, cos_outgoing, smooth || !glossy_);
        return bsdf;
    }
    if (detail.anisotropy > 0.0f) stretch(detail, bsdf);
    if (m.model != scene::SurfaceModel::gltf) {
        reflect_as_blender(material, shape, base_color, roughness, cos_outgoing, bsdf);
        return bsdf;
    }
    if (m.iridescence > 0.0f) {
        bsdf.f0 = film_over(material, shape, cos_outgoing, bsdf.f0);
        surface.coat = largest(bsdf.f0);
        surface.metal_f0 = bsdf.f0;
    }
    if (!bsdf.has_lobe()) return bsdf;

    // Give the reflection to a traced ray or to the lobe.
    const bool traced = mirrors_ && smooth && !bsdf.is_stretched();
    if (glossy_ && !traced) {
        lay_below_lobe(bsdf, surface, cos_outgoing);
    } else {
        if (traced) bsdf.mirror = fresnel(bsdf.f0, cos_outgoing, bsdf.f90);
        bsdf.f0 = glm::vec3{0.0f};
        lay_below_mirror(bsdf, surface, cos_outgoing);
    }
    return bsdf;
}

}  // namespace render2mpeg::renderer
