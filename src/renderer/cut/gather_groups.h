#pragma once
// Groups gather points of a tile into packets of sixteen.
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// Smaller groups of a block look for others in the tile. chosen: 13 of 8 to 16 (docs/measurements.md#lightcuts).
inline constexpr std::size_t large_group = 13;

/// Up to sixteen gather points that are gathered together.
struct GatherGroup {
    std::vector<std::uint32_t> points;  ///< indices into their tile, at least one
    int set = 0;                        ///< of representatives that they are lit by: their first's
};

/// Parts the points of a tile into groups: those of one representative set and one block that lie on much the same
/// surface; points that small groups leave over join others of the tile, of their own set where one takes them, else of
/// another. A pixel's set is its place in a pattern of `sets` pixels (1, or representative_sets) that repeats over the
/// picture, so that the error of a set is spread over the picture as a pattern of the highest frequency, not as a
/// stain. Grouping decides only how much work points share, never how well any of them is lit. `eye` is where distances
/// are judged from.
std::vector<GatherGroup> group_points(const GatherTile& tile, glm::vec3 eye, int sets);

/// How alike points of a group are.
struct Likeness {
    float least_normal;  ///< cosine between two normals
    float largest_step;  ///< off the plane of the first point, over its distance to the eye
    float largest_gap;   ///< between points, likewise
};

/// Whether two points lie on much the same surface, so that their cuts have much in common.
bool share_surface(const GatherPoint& first, const GatherPoint& other, glm::vec3 eye, const Likeness& likeness);

/// The block that a pixel of a tile (GatherPoint::pixel) belongs to, 0..15: sixteen pixels that share a cut if they
/// show one surface.
int block_of(int pixel, int sets);

}  // namespace render2mpeg::renderer
