#pragma once
// Light of hot bodies.
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// Colour of a black body at a temperature in kelvin, by linear Rec. 709 primaries, luminance 1; clamped to 800..12000
/// K.
glm::vec3 blackbody_color(float kelvin);

/// Radiance by unit of way of Blender's flames: its colour times sigma / pi (1 + intensity (T^4 - 1)) of Stefan and
/// Boltzmann's law, in Cycles' units of a megawatt.
glm::vec3 blackbody_radiance(float kelvin, float intensity);

}  // namespace render2mpeg::renderer
