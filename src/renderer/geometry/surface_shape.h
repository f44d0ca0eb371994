#pragma once
// The geometry of a surface about one point.
#include <glm/glm.hpp>

#include "core/surface_address.h"
#include "image/texture.h"
#include "renderer/geometry/object_instant.h"
#include "renderer/geometry/surface_footprint.h"

namespace render2mpeg::renderer {

/// The geometry of a surface about one point, at one instant. Normals are on the side of the triangle's
/// front: the side from which it runs counter-clockwise, or clockwise where a transform mirrors it [glTF2, 3.7.4].
struct SurfaceShape {
    const scene::Mesh* mesh = nullptr;
    glm::uvec3 corners{0};         ///< the triangle's vertices
    glm::vec3 weights{1, 0, 0};    ///< of the three at the point
    glm::vec3 edge1{0}, edge2{0};  ///< from the first corner to the others, world
    glm::vec3 position{0};
    float position_error = 0;         ///< see SurfacePoint
    glm::vec3 front_normal{0, 0, 1};  ///< unit, of the triangle
    glm::vec3 smooth_normal{0, 0,
                            1};  ///< unit, interpolated; the triangle's where the mesh has none or it makes no sense
    /// The footprint's edges as changes of the weights of the second and third corner.
    glm::vec2 barycentric_dx{0}, barycentric_dy{0};
};

/// By how much rounding grows on the way through a transform: the largest of its column lengths over the smallest.
float distortion_of(const glm::mat4& m);

/// `instanced`: rays meet the object through a transform of its own (RayTracer::is_instanced).
SurfaceShape shape_at(const ObjectInstant& object, const core::SurfaceAddress& address,
                      const SurfaceFootprint& footprint, bool instanced);

/// The normal that smooth shading interpolates at weights (1 - u - v, u, v), which may lie outside the triangle.
glm::vec3 smooth_normal_at(const ObjectInstant& object, const SurfaceShape& shape, float u, float v);

/// The smooth surface that a mesh with interpolated normals stands for, as seen from a point of its triangle. Shadow
/// rays start there and light reaches what lies before it, so that shadows of a surface on itself end where its shading
/// does, not at edges of triangles. Both 0 on flat surfaces; nothing is lifted in hollows.
struct SmoothSurface {
    glm::vec3 lift{0};  ///< to it from the point, world
    glm::vec3 tilt{0};  ///< to its unit normal from the triangle's
};

/// `back_side`: as seen from behind the triangle's front.
SmoothSurface smooth_surface_at(const ObjectInstant& object, const SurfaceShape& shape, bool back_side);

/// Where and how widely a texture is looked up.
struct TextureSite {
    glm::vec2 uv{0};
    image::Footprint footprint;
};
TextureSite site_of(const SurfaceShape& shape, const scene::TextureUse& use);

/// The directions in the surface in which a texture's image runs right and up, at right angles to the smooth normal;
/// false where the texture coordinates do not say [glTF2, 3.7.2.1].
bool tangents_of(const ObjectInstant& object, const SurfaceShape& shape, const scene::TextureUse& use, glm::vec3& right,
                 glm::vec3& up);

/// Vertex colour at the point; white where the mesh has none.
glm::vec4 vertex_color(const SurfaceShape& shape);

}  // namespace render2mpeg::renderer
