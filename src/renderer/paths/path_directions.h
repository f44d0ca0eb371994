#pragma once
// Chooses the directions in which paths leave surfaces.
#include <glm/glm.hpp>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Of a surface that is seen from `p.outgoing`: what its diffuse part and its lobe reflect of even light.
glm::vec3 whole_albedo(const SurfacePoint& p);

/// The chance to choose a direction by the lobe instead of the cosine.
float lobe_chance(const SurfacePoint& p);

/// Density of directions, per steradian: cosine and visible normals [Heitz2018] mixed by that chance.
float direction_density(const SurfacePoint& p, float chance, glm::vec3 direction);

/// A direction of that density. `u` in [0, 1)^2.
glm::vec3 chosen_direction(const SurfacePoint& p, bool by_lobe, glm::vec2 u);

}  // namespace render2mpeg::renderer
