#pragma once
// The irradiance that area lamps send where nothing stands in the way, in closed form.
#include <glm/glm.hpp>
#include <span>

#include "renderer/base/area_lamp.h"

namespace render2mpeg::renderer {

/// Irradiance of a convex polygon of radiance 1 at a place with this unit normal, clipped to the horizon: half the sum
/// of the angles that its edges span, each times the normal's component across it [Lambert1760]. At least 0; 0 in the
/// polygon's plane. The polygon's order does not matter.
double polygon_irradiance(std::span<const glm::vec3> corners, glm::vec3 place, glm::vec3 normal);

/// Irradiance of a disc or sphere of radiance 1 that spans a cone, of which the squared sine of half the angle is
/// given (0..1), about a direction whose cosine to the normal is given: pi sin^2 cos above the horizon, and a closed
/// form across it [Snyder1996].
double cone_irradiance(double cosine, double sine_squared);

/// Of a lamp of radiance 1, nothing in the way.
float unoccluded_irradiance(const AreaLamp& lamp, glm::vec3 place, glm::vec3 normal);

}  // namespace render2mpeg::renderer
