#pragma once

#include <glm/glm.hpp>

#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {

/// GGX width below which a lobe counts as narrow.
inline constexpr float narrow_alpha = scene::narrow_roughness * scene::narrow_roughness;

/// How a point scatters light: a Lambert part below one GGX lobe, in glTF 2.0's mixing [glTF2, appendix B], plus what
/// only a traced ray can follow. Reflectances are per channel. With s Schlick's fifth power of the angle between light
/// and half vector,
///     f_s = diffuse / pi x (1 - s where there is a lobe) + D V (f0 (1 - s) + f90 s).
struct Bsdf {
    glm::vec3 diffuse{0};       ///< Lambert reflectance, 0..1; the lobe's s takes its part, all other losses are in it
    glm::vec3 f0{0};            ///< reflectance of the GGX lobe at normal incidence; 0: no lobe
    float alpha = 1;            ///< GGX width, roughness squared, >= mirror_roughness squared
    glm::vec3 mirror{0};        ///< share of light from the mirrored direction (smooth surfaces); 0: none
    glm::vec3 transmission{0};  ///< share that passes (glass), tinted
    float ior = 1.5f;           ///< inside over outside, for glass
    glm::vec3 f90{1};           ///< reflectance of the GGX lobe at grazing incidence; as f0 above 1 on rough metals

    /// Multiplies all that leaves the surface.
    void scale(float by) {
        diffuse *= by;
        f0 *= by;
        f90 *= by;
        mirror *= by;
        transmission *= by;
    }
    bool has_glossy() const { return f0.x > 0 || f0.y > 0 || f0.z > 0; }
    /// Whether rays look along the lobe (lobe_rays.h).
    bool has_narrow_lobe() const { return has_glossy() && alpha < narrow_alpha; }
    bool has_diffuse() const { return diffuse.x > 0 || diffuse.y > 0 || diffuse.z > 0; }
};

/// f_s of the diffuse and the glossy part, per steradian, without the cosine; 0 where `to_light` or `outgoing` lies
/// behind the normal. All directions unit.
glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light);

/// Lambert reflectance for a pair of unit directions: `diffuse`, less what the lobe above it takes.
glm::vec3 diffuse_weight(const Bsdf& bsdf, glm::vec3 outgoing, glm::vec3 to_light);

/// What the two parts reflect of even light, seen from a direction with this cosine to the normal.
glm::vec3 diffuse_albedo(const Bsdf& bsdf, float cosine);
glm::vec3 glossy_albedo(const Bsdf& bsdf, float cosine);

/// A direction that the GGX lobe may scatter to, chosen by its distribution of half vectors, and what it reflects over
/// the density of choosing it; 0 where the direction falls below the surface. [Walter2007, eqs. 35, 38, 41]
struct LobeSample {
    glm::vec3 direction{0};
    glm::vec3 weight{0};
};
LobeSample sample_glossy(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u);

/// A half vector in proportion to what is seen of facets of width `alpha` from `outgoing` (unit); z is along the
/// normal. [Heitz2018, listing 1]
glm::vec3 visible_normal(glm::vec3 outgoing, float alpha, glm::vec2 u);

}  // namespace render2mpeg::renderer
