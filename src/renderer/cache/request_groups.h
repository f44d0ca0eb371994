#pragma once
// Groups scattered gather points that share a cut.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/surface/frame.h"

namespace render2mpeg::renderer {

/// A gather point that wants to be gathered.
struct PointRef {
    /// As `record`: there is none.
    static constexpr std::uint32_t none = 0xffffffffu;

    std::uint32_t tile = 0, index = 0;
    std::uint32_t record = none;  ///< of the very same place, which wants more rays
    bool operator==(const PointRef&) const = default;
};

/// Up to sixteen of them that are gathered together.
struct RequestGroup {
    std::vector<PointRef> points;
    int set = 0;  ///< of representatives
};

/// The set of representatives that a pixel's records take: evenly spread over pixels, and over every second and every
/// fourth of them alike.
int record_set(int x, int y);

/// Tiles to each side of an area whose requests may meet in a group: 64 pixels.
inline constexpr int area_tiles = 4;

/// Parts scattered requests of one area into groups of one set and one surface, as far as there are enough; what is
/// left over joins others. As with group_points this decides only how work is shared.
std::vector<RequestGroup> group_requests(const Frame& seen, const std::vector<PointRef>& requests, glm::vec3 eye);

}  // namespace render2mpeg::renderer
