#pragma once
// Phong materials of older formats as glTF's.
#include <glm/glm.hpp>

#include "scene/model/camera.h"
#include "scene/model/light.h"
#include "scene/model/material.h"

namespace render2mpeg::scene {

/// A surface in the terms of MTL, 3DS, COLLADA and FBX.
struct PhongLook {
    glm::vec3 diffuse{0.6f};      ///< Kd, reflectance 0..1
    glm::vec3 specular{0};        ///< Ks times the format's own strength of the highlight
    float exponent = 0;           ///< Ns; 0: the format gave none
    glm::vec3 emission{0};        ///< Ke, taken as radiance
    float opacity = 1;            ///< d
    glm::vec3 filter{1};          ///< Tf, colour of light transmitted through glass
    float ior = 1;                ///< Ni; 1: not said
    int illumination_model = -1;  ///< MTL's illum; -1: not said
    float metallic = -1;          ///< Pm; -1: not said
    float roughness = -1;         ///< Pr; -1: not said
    float reflectivity = 0;       ///< FBX's share of reflection, 0..1
    glm::vec3 reflection{-1};     ///< its colour; negative: not said
};

/// Perceptual roughness of the GGX lobe that matches a Blinn-Phong lobe: alpha = sqrt(2 / (n + 2)), roughness =
/// sqrt(alpha). 1 for n <= 0. [Walter2007, 5.2]
float roughness_of_exponent(float exponent);

/// Sets base colour, reflection, transmission, alpha and emission, but no textures or sides.
void apply(const PhongLook& look, Material& material);

/// Light of classic shading: its colour is its strength, attenuated by 1 / (c + l d + q d^2).
struct ClassicLight {
    LightKind kind = LightKind::point;
    glm::vec3 color{1};
    double constant = 0, linear = 1, quadratic = 0;  ///< 0, 1, 0: the file says nothing
    float inner_angle = 0, outer_angle = 0;          ///< spot: full angles of the cones, radians
};

/// Colour, strength and cones. Inverse square falloff replaces classic attenuation; both agree at `distance` > 0.
/// Colour 1 shows a white Lambert surface at radiance 1: irradiance pi.
Light physical_light(const ClassicLight& classic, double distance);

/// The same for Blender's units: watts of points and spots, W/m^2 of suns.
Light blender_light(const ClassicLight& classic);

/// Whether its file says inverse square falloff, or none by nature.
bool falls_off_physically(const ClassicLight& classic);

struct ClassicCamera {
    double horizontal_angle = 0;  ///< full angle, radians; not in (0.02, 3.1): the file says nothing
    double aspect = 0;            ///< width over height; 0: not said
    double half_width = 0;        ///< > 0: orthographic
};

CameraLens lens_of(const ClassicCamera& classic);

}  // namespace render2mpeg::scene
