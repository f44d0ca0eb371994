#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/gather_lanes.h"

namespace render2mpeg::renderer {

/// Indices into a tile of up to sixteen gather points that are gathered together.
using GatherGroup = std::vector<std::uint32_t>;

/// Parts the points of a tile into groups: those of a 4x4 block that lie on much the same surface. Grouping decides
/// only how much work points share, never how well any of them is lit. `eye` is where distances are judged from.
std::vector<GatherGroup> group_points(const GatherTile& tile, glm::vec3 eye);

}  // namespace render2mpeg::renderer
