#pragma once
// Lights of older formats as glTF's.
#include <glm/glm.hpp>

#include "scene/model/camera.h"
#include "scene/model/light.h"

namespace render2mpeg::scene {

/// A light as the older formats' shading knows it: a colour that is also its strength, attenuated by 1 / (c + l d + q
/// d^2).
struct ClassicLight {
    LightKind kind = LightKind::point;
    glm::vec3 color{1};
    double constant = 0, linear = 1, quadratic = 0;  ///< 0, 1, 0: the file says nothing
    float inner_angle = 0, outer_angle = 0;          ///< spot: full angles of the cones, radians
};

/// Colour, strength and cones, name and node aside. `distance` > 0 is where the light is to be as bright as its own
/// format shades it: from there it falls off by the inverse square, as light does. A classic light of colour 1 shows a
/// white Lambert surface at radiance 1, so that its irradiance is pi.
Light physical_light(const ClassicLight& classic, double distance);

/// The same for a light whose colour holds Blender's strength: watts of points and spots, watts per square metre of
/// suns. As bright as in a .blend.
Light blender_light(const ClassicLight& classic);

/// Does it fall off by the inverse square, or not at all by nature, in its own file already?
bool falls_off_physically(const ClassicLight& classic);

/// What the formats say of a camera's picture.
struct ClassicCamera {
    double horizontal_angle = 0;  ///< full angle, radians; not in (0.02, 3.1): the file says nothing
    double aspect = 0;            ///< width over height; 0: not said
    double half_width = 0;        ///< > 0: orthographic
};

CameraLens lens_of(const ClassicCamera& classic);

}  // namespace render2mpeg::scene
