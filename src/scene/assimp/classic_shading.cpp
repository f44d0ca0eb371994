#include "scene/assimp/classic_shading.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

float largest(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}

/// NaN becomes 0; at most 1.
glm::vec3 reflectance(glm::vec3 v) {
    return core::is_finite(v) ? glm::clamp(v, glm::vec3(0), glm::vec3(1)) : glm::vec3(0);
}

/// MTL's illumination models that speak of refraction or glass: 4, 6, 7, 9. [MTL, illum]
bool says_glass(int model) {
    return model == 4 || model == 6 || model == 7 || model == 9;
}

/// Those that say refraction; 4 and 9 say glass, which windows are too. [MTL, illum]
bool says_refraction(int model) {
    return model == 6 || model == 7;
}

/// Those that trace reflections of an opaque surface: 3, 5. [MTL, illum]
bool says_mirror(int model) {
    return model == 3 || model == 5;
}

/// Reflectance at normal incidence. Ks has two traditions: physically minded authors write the reflectance itself (0.04
/// for varnish, 0.8 for steel with a dark Kd), the others the strength of a highlight (0.5 or 0.9 beside a bright Kd),
/// which as a reflectance would turn every painted wall into a half mirror. chosen: Ks as it is where the surface is
/// said to mirror or is mostly specular (Ks >= 0.3 and Kd <= Ks / 4: the steel, gold and mirrors of the public bathroom
/// and Cornell scenes are all beyond, their paints all below), else at most 0.04 (1 + Ks), the 4..8 % of dielectrics.
glm::vec3 normal_reflectance(const PhongLook& look) {
    const glm::vec3 ks = reflectance(look.specular);
    const bool mostly_specular = largest(ks) >= 0.3f && largest(look.diffuse) <= largest(ks) / 4;
    if (mostly_specular || says_mirror(look.illumination_model)) return ks;
    return glm::min(ks, 0.04f * (1.0f + ks));
}

bool attenuation_unsaid(const ClassicLight& l) {
    return l.constant == 0 && l.linear == 1 && l.quadratic == 0;
}

/// From colour to radiant intensity (point, spot) or irradiance (directional).
double physical_factor(const ClassicLight& l, double distance) {
    if (l.kind == LightKind::directional) return glm::pi<double>();
    const double squared = distance * distance;
    const double attenuation = attenuation_unsaid(l) ? 1 : l.constant + l.linear * distance + l.quadratic * squared;
    return glm::pi<double>() * core::divide_or(squared, attenuation, squared);
}

Light light_of_strength(const ClassicLight& classic, double factor) {
    Light light;
    light.kind = classic.kind;
    const glm::vec3 color = core::is_finite(classic.color) ? glm::max(classic.color, glm::vec3(0)) : glm::vec3(0);
    const float peak = std::max({color.r, color.g, color.b});
    const double strength = peak * factor;
    light.intensity = std::isfinite(static_cast<float>(strength)) ? static_cast<float>(std::max(strength, 0.0)) : 0;
    light.color = peak > 0 ? color / peak : glm::vec3(1);
    if (light.kind == LightKind::spot) {
        light.outer_cone = std::clamp(0.5f * classic.outer_angle, 0.01f, glm::half_pi<float>());
        light.inner_cone = std::clamp(0.5f * classic.inner_angle, 0.0f, 0.999f * light.outer_cone);
    }
    return light;
}

}  // namespace

float roughness_of_exponent(float exponent) {
    if (!(exponent > 0)) return 1;
    return std::clamp(std::sqrt(std::sqrt(2.0f / (exponent + 2.0f))), 0.0f, 1.0f);
}

void apply(const PhongLook& look, Material& material) {
    const float opacity = std::isfinite(look.opacity) ? std::clamp(look.opacity, 0.0f, 1.0f) : 1.0f;
    material.emission = core::is_finite(look.emission) ? glm::max(look.emission, glm::vec3(0)) : glm::vec3(0);

    // Glass: refraction is said outright, or the surface is all but invisible and has an index of refraction.
    const bool glass = says_glass(look.illumination_model) || (opacity <= 0.1f && look.ior > 1.01f);
    if (glass) {
        const glm::vec3 filter = reflectance(look.filter);
        material.base_color = glm::vec4(largest(filter) > 0 ? filter : glm::vec3(1), 1);
        material.transmission = 1;
        material.roughness = look.roughness >= 0 ? std::min(look.roughness, 1.0f) : 0;
        material.metallic = 0;
        material.ior = std::isfinite(look.ior) && look.ior > 1.01f ? look.ior : 1.5f;
        if (says_refraction(look.illumination_model) || (opacity <= 0.1f && look.ior > 1.01f))
            material.thickness = Thickness::solid_where_closed;
        return;
    }

    // The physically based extension of MTL, and FBX's newer materials, need no conversion.
    material.base_color = glm::vec4(reflectance(look.diffuse), opacity);
    if (opacity < 1) material.alpha_mode = AlphaMode::blend;
    if (look.metallic >= 0 || look.roughness >= 0) {
        // Blender's FBX says metalness as reflection in the surface's own colour; otherwise it is a clear coat's.
        const bool metal = look.metallic < 0 && look.reflection == look.diffuse;
        material.metallic = std::clamp(metal ? look.reflectivity : look.metallic, 0.0f, 1.0f);
        material.roughness =
            look.roughness >= 0 ? std::min(look.roughness, 1.0f) : roughness_of_exponent(look.exponent);
        return;
    }

    material.specular_glossiness = true;
    material.specular = normal_reflectance(look);
    const bool mirror = look.illumination_model == 5 && largest(material.specular) > 0;
    material.glossiness = mirror ? 1.0f : 1.0f - roughness_of_exponent(look.exponent);
    material.roughness = 1 - material.glossiness;
    if (largest(material.specular) <= 0) material.glossiness = 0;
}

Light physical_light(const ClassicLight& classic, double distance) {
    EXPECTS(distance > 0);
    return light_of_strength(classic, physical_factor(classic, distance));
}

Light blender_light(const ClassicLight& classic) {
    return light_of_strength(classic, classic.kind == LightKind::directional ? 1 : 1 / (4 * glm::pi<double>()));
}

bool falls_off_physically(const ClassicLight& l) {
    return l.kind == LightKind::directional || (l.constant == 0 && l.linear == 0 && l.quadratic > 0);
}

CameraLens lens_of(const ClassicCamera& classic) {
    CameraLens lens;
    // chosen: 4:3 where the file does not say the picture's shape, as the formats of that time meant; 60 degrees where
    // it does not say the angle.
    const double aspect = std::isfinite(classic.aspect) && classic.aspect > 0.01 ? classic.aspect : 4.0 / 3.0;
    if (std::isfinite(classic.aspect) && classic.aspect > 0.01) lens.aspect = static_cast<float>(classic.aspect);
    double horizontal = classic.horizontal_angle;
    if (!(horizontal > 0.02) || !(horizontal < 3.1)) horizontal = glm::pi<double>() / 3;
    lens.vertical_fov = static_cast<float>(2 * std::atan(std::tan(horizontal / 2) / aspect));
    if (classic.half_width > 0 && std::isfinite(classic.half_width)) {
        lens.projection = ProjectionKind::orthographic;
        lens.y_magnification = static_cast<float>(classic.half_width / aspect);
    }
    return lens;
}

}  // namespace render2mpeg::scene
