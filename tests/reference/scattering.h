#pragma once

#include <glm/glm.hpp>

#include "renderer/surface/surface_point.h"
#include "scene/model/animation.h"

namespace render2mpeg::reference {

/// How a surface scatters, written from the sources in double precision and without any code of the renderer's: glTF
/// 2.0's mixing [glTF2, appendix B] with multiple scattering [Turquin2019] (docs/model/materials.md).
struct Scattering {
    glm::dvec3 diffuse{0}, f0{0}, f90{1};
    double alpha = 1;

    /// f_s times the cosine to the light, per steradian; 0 below the surface. All directions unit.
    glm::dvec3 times_cosine(glm::dvec3 normal, glm::dvec3 outgoing, glm::dvec3 to_light) const;
};

/// Of a point whose material has neither images nor vertex colours and is metallic-roughness, of its numbers alone; of
/// others, what the renderer looked up.
Scattering scattering_of(const scene::Animation& animation, const renderer::SurfacePoint& point);

/// Of a metallic-roughness material without images, seen with this cosine; roughness >= 0.1.
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
