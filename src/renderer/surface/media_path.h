#pragma once
// A ray's way through bodies of glass.
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// State of one ray in bodies of glass: the media it is in, and its band of light. Costs nothing in scenes without such
/// bodies.
struct MediaPath {
    MediaStack media;
    Band band = Band::all;

    /// Share of light that is left of the way to a hit. Notes a body whose back is met though it was never entered:
    /// the ray began inside.
    glm::vec3 way_to(const PosedScene& scene, const Hit& hit, glm::vec3 direction);

    /// The surface as the ray meets it.
    SurfacePoint surface_at(const PosedScene& scene, const Hit& hit, glm::vec3 direction,
                            const SurfaceFootprint& footprint = {}, float time = scene::middle_time) const;

    /// Passes the boundary of a body by a facet with this normal (on the side of `point.outgoing`); returns where the
    /// ray goes on, 0 where all is reflected.
    glm::vec3 cross(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet);
};

/// A direction that leaves a surface less than this above its geometric normal is lifted to it: bent normals must not
/// send it to the other side. chosen: above the rounding of the reflection; tried 1e-5..1e-2.
inline constexpr float least_leaving_cosine = 1e-3f;

/// The facet of a body's boundary that a ray meets: the shading normal, or, of rough glass, one chosen by what is seen
/// of facets.
glm::vec3 facet_of(const SurfacePoint& point, glm::vec2 u);

}  // namespace render2mpeg::renderer
