#pragma once

#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// How a point scatters light: Lambert plus one GGX lobe, in glTF 2.0's mixing [glTF2, appendix B], plus what only a
/// traced ray can follow. All reflectances are per channel, 0..1.
struct Bsdf {
    glm::vec3 diffuse{0};       ///< Lambert reflectance, Fresnel loss included
    glm::vec3 f0{0};            ///< reflectance of the GGX lobe at normal incidence; 0: no lobe
    float alpha = 1;            ///< GGX width, roughness squared, >= mirror_roughness squared
    glm::vec3 mirror{0};        ///< share of light from the mirrored direction (smooth surfaces); 0: none
    glm::vec3 transmission{0};  ///< share that passes (glass), tinted
    float ior = 1.5f;           ///< inside over outside, for glass

    bool has_glossy() const { return f0.x > 0 || f0.y > 0 || f0.z > 0; }
    bool has_diffuse() const { return diffuse.x > 0 || diffuse.y > 0 || diffuse.z > 0; }
};

/// f_s of the diffuse and the glossy part, per steradian, without the cosine; 0 where `to_light` or `outgoing` lies
/// behind the normal. All directions unit.
glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light);

/// What the GGX lobe reflects of diffuse light, about: its Fresnel reflectance averaged over the hemisphere with the
/// cosine, f0 + (1 - f0) / 21 by Schlick's formula (2 / (6 x 7) = 1 / 21). 0 without a lobe.
glm::vec3 glossy_albedo(const Bsdf& bsdf);

/// A direction that the GGX lobe may scatter to, chosen by its distribution of half vectors, and what it reflects over
/// the density of choosing it; 0 where the direction falls below the surface. [Walter2007, eqs. 35, 38, 41]
struct LobeSample {
    glm::vec3 direction{0};
    glm::vec3 weight{0};
};
LobeSample sample_glossy(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u);

}  // namespace render2mpeg::renderer
