#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/model/mesh.h"

/// The solids that an animation file can name. All wind counter-clockwise as seen from outside and have normals and
/// texture coordinates, v pointing down. Sizes are scene units, > 0.
namespace render2mpeg::scene {

/// How texture coordinates are laid out: the image once over a face or once about a body, or in scene units, so that a
/// texture has the same size on all shapes.
enum class TextureLayout { fit, units };

/// Stands on y = 0, with its middle over the origin. Each face shows the image upright.
Mesh box_mesh(glm::dvec3 size, TextureLayout layout);

/// Lies at y = 0 and faces up: size.x along x, size.y along z.
Mesh plane_mesh(glm::dvec2 size, TextureLayout layout);

/// Stands upright about the origin and faces +z.
Mesh quad_mesh(glm::dvec2 size, TextureLayout layout);

/// Turns an outline of (radius, height) points about the y axis. The outline runs upwards for a body that faces
/// outwards; corners sharper than `crease` degrees stay sharp. At least two points, radius >= 0. `segments` >= 3 lie
/// around.
Mesh lathe_mesh(const std::vector<glm::dvec2>& outline, int segments, double crease, TextureLayout layout);

/// About the origin.
Mesh sphere_mesh(double radius, int segments, TextureLayout layout);

/// A sphere about the origin as a lamp is: 1,280 triangles with the area of the true sphere, whose shadow in every
/// direction is a circle's area to 0.06 %, so that it lights as the sphere would.
Mesh lamp_mesh(double radius);

/// Stands on y = 0; closed above and below. `top_radius` 0 is a cone.
Mesh cylinder_mesh(double radius, double top_radius, double height, int segments, TextureLayout layout);

/// Lies at y = 0 and faces up.
Mesh disc_mesh(double radius, int segments, TextureLayout layout);

/// Lies about the y axis around the origin, `radius` to the middle of the tube.
Mesh torus_mesh(double radius, double tube_radius, int segments, TextureLayout layout);

/// A wall `size.x` wide, `size.y` high and `size.z` deep that stands on y = 0 with a round-headed opening of
/// `opening.x` by `opening.y` in its middle, which reaches the ground: opening.x < size.x, opening.x / 2 <= opening.y <
/// size.y.
Mesh arch_mesh(glm::dvec3 size, glm::dvec2 opening, int segments, TextureLayout layout);

}  // namespace render2mpeg::scene
