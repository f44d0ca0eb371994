#pragma once
// Parameters of fibres of hair [Chiang2016].
#include <glm/glm.hpp>

namespace render2mpeg::scene {

/// Strands of a material that has this show it in place of all else; where their mesh has vertex colours, these are
/// colours of grooms, whose absorption is added.
struct Hair {
    glm::vec3 absorption{0};                             ///< per radius of the fibre, >= 0
    float roughness = 0.3f, azimuthal_roughness = 0.3f;  ///< along the fibre, and about it; 0..1
    float coat = 0;                                      ///< 0..1: by how much the first reflection is less rough
    float ior = 1.55f;                                   ///< > 1
    float tilt = 0.034906585f;  ///< of the scales, radians: the first reflection leans to the root
};

/// Absorption of fibres that give a groom this colour, 0..1 [Chiang2016, eq. 9]; and its inverse.
glm::vec3 absorption_of(glm::vec3 color, float azimuthal_roughness);
glm::vec3 color_of(glm::vec3 absorption, float azimuthal_roughness);

/// Absorption of pigments, of which `redness` (0..1) is pheomelanin, the rest eumelanin. `melanin` in 0..1 stands for
/// -log(1 - melanin).
glm::vec3 absorption_of_melanin(float melanin, float redness);

}  // namespace render2mpeg::scene
