#pragma once
// Lights of older formats as glTF's.
#include <glm/glm.hpp>

#include "scene/model/camera.h"
#include "scene/model/light.h"

namespace render2mpeg::scene {

/// Light of classic shading: its colour is its strength, attenuated by 1 / (c + l d + q d^2).
struct ClassicLight {
    LightKind kind = LightKind::point;
    glm::vec3 color{1};
    double constant = 0, linear = 1, quadratic = 0;  ///< 0, 1, 0: the file says nothing
    float inner_angle = 0, outer_angle = 0;          ///< spot: full angles of the cones, radians
};

/// Colour, strength and cones. Inverse square falloff replaces classic attenuation; both agree at `distance` > 0.
/// Colour 1 shows a white Lambert surface at radiance 1: irradiance pi.
Light physical_light(const ClassicLight& classic, double distance);

/// The same for Blender's units: watts of points and spots, W/m^2 of suns.
Light blender_light(const ClassicLight& classic);

/// Whether its file says inverse square falloff, or none by nature.
bool falls_off_physically(const ClassicLight& classic);

struct ClassicCamera {
    double horizontal_angle = 0;  ///< full angle, radians; not in (0.02, 3.1): the file says nothing
    double aspect = 0;            ///< width over height; 0: not said
    double half_width = 0;        ///< > 0: orthographic
};

CameraLens lens_of(const ClassicCamera& classic);

}  // namespace render2mpeg::scene
