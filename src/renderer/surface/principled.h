#pragma once
// Blender's Principled BSDF as its versions 3 and 4 have it, in the parts of a Bsdf.
#include <glm/glm.hpp>

#include "renderer/surface/bsdf.h"
#include "scene/model/material.h"

namespace render2mpeg::renderer {

// chosen: no dielectric reflects more at normal incidence, and no metal so little.
inline constexpr float most_of_dielectrics = 0.2f;

/// A material's inputs at a point, textures looked up.
struct PrincipledInputs {
    scene::SurfaceModel model = scene::SurfaceModel::principled_3;
    glm::vec3 base{0};
    float metallic = 0, roughness = 0, transmission = 0;  ///< 0..1
    float specular_f0 = 0.04f;                            ///< of the dielectric, without its tint
    glm::vec3 tint{1};
    float glass_f0 = 0.04f;     ///< of what is transparent
    glm::vec3 gloss{0};         ///< scene::Material's
    bool multiscatter = false;  ///< likewise
    float cosine = 1;           ///< of the outgoing direction
    bool smooth = false;        ///< a mirror in place of the lobe
};

/// Lowers the diffuse part by what lies over it, and sets its shape, the lobe or the mirror; `bsdf.alpha` and its
/// direction are set. Transmission is not.
void reflect_as_principled(const PrincipledInputs& in, Bsdf& bsdf);

/// Blender's coat: upon all else in version 3, over what it leaves, tinted, in version 4.
struct CoatInputs {
    float share = 0, roughness = 0;      ///< 0..1
    float cosine = 1;                    ///< of the outgoing direction
    bool mirrors = true, glossy = true;  ///< whether these passes run
};
void lay_coat(const scene::Material& m, const CoatInputs& in, Bsdf& bsdf);

/// Gives the diffuse part the material's roughness; since Blender 4.3 with light that facets send to each other.
/// [Fujii2012; Portsmouth2025]
void roughen(const scene::Material& m, glm::vec3 color, float cosine, Bsdf& bsdf);

/// Lowers the diffuse part until no channel sends more than it receives of even light.
void keep_energy(Bsdf& bsdf, float cosine);

}  // namespace render2mpeg::renderer
