#pragma once

#include <glm/glm.hpp>

#include "scene/model/animation.h"

namespace render2mpeg::reference {

/// What a material says of one point, images and vertex colours looked up.
struct Look {
    bool specular_glossiness = false;
    glm::dvec3 base{1};        ///< 0..1; the diffuse colour where `specular_glossiness`
    double metallic = 0;       ///< 0..1
    double roughness = 1;      ///< 0..1; 1 - glossiness
    double ior = 1.5;          ///< >= 1
    double transmission = 0;   ///< 0..1
    bool solid = false;        ///< bounds a body that bends light; all of it smooth glass
    glm::dvec3 absorption{0};  ///< of the body, per scene unit
    glm::dvec3 specular{0};    ///< of `specular_glossiness`, 0..1
    double coverage = 1;       ///< 0: a hole
    glm::dvec3 emission{0};    ///< radiance of the side that is looked at
    bool unlit = false;        ///< shows `emission`, scatters nothing
};

/// How a surface scatters light, written from the sources in double precision and without any code of the renderer's:
/// glTF 2.0's mixing [glTF2, appendix B] with multiple scattering [Turquin2019], and what docs/model/materials.md says
/// of mirrors and glass.
struct Scattering {
    glm::dvec3 diffuse{0}, f0{0}, f90{1};
    double alpha = 1;
    glm::dvec3 mirror{0};        ///< share of light from the mirrored direction
    glm::dvec3 transmission{0};  ///< share of light that comes straight from behind

    bool has_lobe() const { return f0 != glm::dvec3(0); }

    /// f_s of the diffuse and the glossy part times the cosine to the light, per steradian; 0 below the surface. All
    /// directions unit.
    glm::dvec3 times_cosine(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 to_light) const;

    /// A direction that light may come from: by the cosine, and half of them by visible normals [Heitz2018] where there
    /// is a lobe; and the density of choosing it. `u`: three uniform numbers.
    glm::dvec3 sample(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 u) const;
    double density(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 to_light) const;
};

/// Seen with this cosine to the normal.
Scattering scattering_of(const Look& look, double cosine);

/// Of a metallic-roughness material without images.
Scattering metallic_roughness(const scene::Material& material, double cosine);

/// Integrals over light directions of D V cos (1 - s) and of D V cos s for a GGX lobe, s being Schlick's fifth power of
/// the angle to the half vector: by visible normals [Heitz2018], `steps` squared of them.
struct LobeIntegral {
    double f0 = 0, f90 = 0;
};
LobeIntegral integrate_lobe(double cosine, double alpha, int steps = 200);

/// Mean of s over the hemisphere with the cosine.
double mean_fresnel_power(double cosine);

}  // namespace render2mpeg::reference
