#pragma once
// Phong materials of older formats as glTF's.
#include <glm/glm.hpp>

#include "scene/model/material.h"

namespace render2mpeg::scene {

/// A surface in the terms of MTL, 3DS, COLLADA and FBX.
struct PhongLook {
    glm::vec3 diffuse{0.6f};      ///< Kd, reflectance 0..1
    glm::vec3 specular{0};        ///< Ks times the format's own strength of the highlight
    float exponent = 0;           ///< Ns; 0: the format gave none
    glm::vec3 emission{0};        ///< Ke, taken as radiance
    float opacity = 1;            ///< d
    glm::vec3 filter{1};          ///< Tf, colour of what passes through glass
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

}  // namespace render2mpeg::scene
