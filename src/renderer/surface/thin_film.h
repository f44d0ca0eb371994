#pragma once

#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// Reflectance (per channel of BT.709) of a film of index `film_ior` and `thickness` (nanometres) on a surface that
/// reflects `base_f0` at normal incidence, in air, for light at this cosine to the normal (0..1). Two orders of
/// interference, sensitivities as sums of Gaussians. [KHR_materials_iridescence]
glm::vec3 thin_film(float film_ior, float thickness, float cosine, glm::vec3 base_f0);

/// The reflectance at normal incidence with which Schlick's term is `reflectance` at this cosine; 0..1.
glm::vec3 schlick_f0(glm::vec3 reflectance, float cosine);

}  // namespace render2mpeg::renderer
