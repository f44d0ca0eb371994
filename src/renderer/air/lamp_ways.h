#pragma once
// Light at places within air: of lamps, and rays that look for all else.
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/air/airlight.h"
#include "renderer/base/stream.h"
#include "renderer/base/volume_light.h"

namespace render2mpeg::renderer {

/// What a lamp's light meets on its way to a place.
LampWay way_of_light(const AirInstant& instant, const LightPoint& lamp, glm::vec3 place);

/// Mean radiance over all directions that lamps send to a place; none counts as nearer than `least_distance`.
glm::vec3 mean_of_lamps(const AirInstant& instant, std::span<const LightPoint> lamps, glm::vec3 place,
                        float least_distance);

/// Adds rays in all directions from a place, as even as points of a spiral are, turned by `numbers`.
void add_even_rays(glm::vec3 place, std::size_t count, const Stream& numbers, std::vector<RayQuery>& rays);

/// What rays see where they end, with what surfaces bounce or without, and how far that is; black without gather rays.
/// `numbers`: ray k's are those at k.
std::vector<FinalGather::Seen> seen_at_ends(const AirInstant& instant, std::span<const RayQuery> rays,
                                            const Stream& numbers, bool bounces);

}  // namespace render2mpeg::renderer
