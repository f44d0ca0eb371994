#pragma once
// Sixteen gather points side by side, as the kernels take them.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/lanes.h"
#include "renderer/surface/gather_point.h"

namespace render2mpeg::renderer {

/// Up to sixteen gather points as arrays, so that one light or one node is evaluated for all of them at once. Lanes
/// beyond `count` repeat the first point's place with normals and weights of 0: they receive nothing.
struct alignas(64) GatherLanes {
    int count = 0;
    int set = 0;          ///< of representatives, 0..representative_sets - 1; `fill` leaves it alone
    bool glossy = false;  ///< any lane's Bsdf::has_glossy; without, everything below `schlick_weight` is unset
    Vec3Lanes position;   ///< world
    Vec3Lanes origin;     ///< of shadow rays: on the smooth surface, moved off it along the geometric normal
    int places = 1;       ///< origins of the lane that has most of them, further ones not counted
    /// The other origins (GatherPoint::elsewhere); those of lanes that have fewer repeat. Unset from `places` - 1 on.
    Vec3Lanes elsewhere[most_other_places];
    bool at_one_place = false;                              ///< of points of the air: one ray to a light counts for all
    int own_places[lane_count];                             ///< origins that do not repeat
    const std::vector<glm::vec3>* more_places[lane_count];  ///< GatherPoint::more_places, of a point that lives on
    bool timed = false;  ///< some lane's shadow rays leave while the shutter is open, not all in its middle
    Lanes shadow_part;  ///< where within strata of the shutter's time, 0..1; below 0: in its middle. Unset if not timed
    Vec3Lanes geometric;       ///< the smooth surface's normal: light from behind it is none
    FrameLanes normal;         ///< shading normal
    Vec3Lanes diffuse_weight;  ///< luminance that one unit of irradiance gives the pixel: luminance weights x share x
                               ///< diffuse / pi
    Vec3Lanes f0_weight;       ///< the same for the lobe's two parts, f0 (1 - s) and f90 s
    Vec3Lanes schlick_weight;
    FrameLanes outgoing, mirrored;  ///< to the eye; and that direction mirrored about the normal
    Lanes cos_outgoing;             ///< > 0
    Lanes lobe_width;               ///< alpha squared, of stretched lobes their mean's
    bool stretched = false;         ///< any lane has a stretched lobe or a shape; without, `along` to `rough` are unset
    Vec3Lanes along, across;        ///< the lobe's axes in the surface
    Lanes along2, across2;          ///< its squared widths there; alike in lanes whose lobe is round
    Lanes view_along, view_across;  ///< cosines of these axes to the eye
    Lanes retro, loss, flat, rough;  ///< DiffuseShape
    Lanes rays_see;                  ///< scale of the lobe's share that rays see; 0: no rays. See `by_trees`
    Lanes coat;                      ///< the diffuse part gets 1 - coat s of light
    Lanes lobed;                     ///< 1: the lane has a lobe, else 0
};

/// Origins of each lane's shadow rays at one of its places, 0..places - 1.
inline const Vec3Lanes& origins(const GatherLanes& lanes, int place) {
    return place == 0 ? lanes.origin : lanes.elsewhere[place - 1];
}

/// Fills `lanes` from 1..16 points.
void fill(GatherLanes& lanes, std::span<const GatherPoint* const> points);

/// Unoccluded contribution of a light of unit intensity to each lane: `diffuse` is irradiance, under a lobe the part
/// that passes it; `f0` and `schlick` are the radiance of the GGX lobe, to be multiplied by f0 and by f90. Filled only
/// for glossy lanes but for `diffuse`.
struct alignas(64) LightLanes {
    Lanes diffuse, f0, schlick;
    bool any_clamped = false;  ///< some lane was nearer than the clamping distance
};

}  // namespace render2mpeg::renderer
