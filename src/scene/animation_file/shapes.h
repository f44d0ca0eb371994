#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/model/mesh.h"

/// Solids of an animation file: counter-clockwise from outside, with normals and texture coordinates (v down), in scene
/// units > 0.
namespace render2mpeg::scene {

/// Texture coordinates once over a face or body, or in scene units.
enum class TextureLayout { fit, units };

/// Stands on y = 0, with its middle over the origin. Each face shows the image upright.
Mesh box_mesh(glm::dvec3 size, TextureLayout layout);

/// Lies at y = 0 and faces up: size.x along x, size.y along z.
Mesh plane_mesh(glm::dvec2 size, TextureLayout layout);

/// Stands upright about the origin and faces +z.
Mesh quad_mesh(glm::dvec2 size, TextureLayout layout);

/// Lathes (radius >= 0, height) points, at least two, about the y axis; upwards faces outwards. Corners sharper than
/// `crease` degrees stay sharp. `segments` >= 3.
Mesh lathe_mesh(const std::vector<glm::dvec2>& outline, int segments, double crease, TextureLayout layout);

/// About the origin.
Mesh sphere_mesh(double radius, int segments, TextureLayout layout);

/// Spherical lamp: 1,280 triangles with the true sphere's area; projected areas agree to 0.06 %.
Mesh lamp_mesh(double radius);

/// Stands on y = 0; closed above and below. `top_radius` 0 is a cone.
Mesh cylinder_mesh(double radius, double top_radius, double height, int segments, TextureLayout layout);

/// Lies at y = 0 and faces up.
Mesh disc_mesh(double radius, int segments, TextureLayout layout);

/// Lies about the y axis around the origin, `radius` to the middle of the tube.
Mesh torus_mesh(double radius, double tube_radius, int segments, TextureLayout layout);

/// Wall of `size` on y = 0 with a round-headed opening to the ground in its middle: opening.x < size.x, opening.x / 2
/// <= opening.y < size.y.
Mesh arch_mesh(glm::dvec3 size, glm::dvec2 opening, int segments, TextureLayout layout);

}  // namespace render2mpeg::scene
