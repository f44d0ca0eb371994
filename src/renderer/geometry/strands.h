#pragma once
// Strands of hair as rays meet them: ribbons that face the ray, shaded as the round fibres that they stand for.
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/geometry/object_instant.h"
#include "renderer/geometry/surface_shape.h"

struct RTCDeviceTy;
struct RTCGeometryTy;

namespace render2mpeg::renderer {

/// A place of a strand, in world space.
struct StrandPoint {
    glm::vec3 axis{0};           ///< the middle of the strand
    glm::vec3 tangent{0, 0, 1};  ///< unit, from root to tip
    float radius = 0;
};
StrandPoint strand_at(const ObjectInstant& object, const core::SurfaceAddress& address);

/// The place of the round fibre that is seen from `outgoing` (unit): its position and its normal, which is on the side
/// of `outgoing`.
SurfaceShape strand_shape_at(const ObjectInstant& object, const core::SurfaceAddress& address, glm::vec3 outgoing,
                             bool instanced);

/// Corners and weights by which attributes of a mesh are interpolated, of triangles and strands.
void set_corners(SurfaceShape& shape, const core::SurfaceAddress& address);

/// How far light goes among a mesh's strands until it meets one, in the mean over them and over directions; in its own
/// space. Infinite without strands that have a width.
float free_path_among(const scene::Mesh& mesh);

/// Embree's geometry of a mesh's strands, not yet committed; `width` is a factor on their radii.
RTCGeometryTy* new_strands(RTCDeviceTy* device, const scene::Mesh& mesh,
                           std::span<const std::vector<glm::vec3>* const> steps, float width);
/// Moves the points of such a geometry; whether any was elsewhere.
bool move_strands(glm::vec4* points, const std::vector<glm::vec3>& positions);

}  // namespace render2mpeg::renderer
