#pragma once
// Nearest hits of rays.
#include <span>

#include "renderer/geometry/ray_tracer.h"

struct RTCRay;
struct RTCSceneTy;

namespace render2mpeg::renderer {

class EmbreeScene;

// Nearest hits of rays, for RayTracer.

/// Components beyond this overflow in Embree's products and are refused by its own check.
inline constexpr float largest_component = 1e18f;

/// Half the width of the interval about a hit, relative to its distance, in which surfaces count as lying in one plane.
/// chosen: 16 ulp, several times the rounding of two tessellations of one plane; tried 4..64 ulp.
inline constexpr float coplanar = 0x1p-19f;

/// Whether Embree takes the ray: Debian's aborts on those that are not finite.
bool is_traceable(const RayQuery& query);

/// Embree's form of a ray that begins at distance `near`.
RTCRay ray_of(const RayQuery& query, float near, float far);

/// See RayTracer::nearest.
Hit nearest_hit(const EmbreeScene& scene, const RayQuery& query);
void nearest_hits(const EmbreeScene& scene, std::span<const RayQuery> queries, std::span<Hit> hits);
/// See RayTracer::nearest_of.
Hit nearest_hit_of(const EmbreeScene& scene, std::uint32_t object, const RayQuery& query);
/// See RayTracer::any_nearest.
void any_nearest_hits(const EmbreeScene& scene, std::span<const RayQuery> queries, std::span<Hit> hits, bool coherent);

/// Whether a ray meets anything with a bit of the mask in a scene, translucent or not.
bool meets_any(RTCSceneTy* scene, unsigned mask, const RayQuery& query);

}  // namespace render2mpeg::renderer
