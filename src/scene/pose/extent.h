#pragma once
// Bounding boxes in double precision.
#include <glm/glm.hpp>
#include <optional>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// A box in file space, double precision.
struct Extent {
    glm::dvec3 low{0}, high{0};

    void hold(glm::dvec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
    glm::dvec3 centre() const { return low + 0.5 * (high - low); }
    double radius() const { return 0.5 * glm::length(high - low); }
};

/// Box of all visible triangles, strands and volumes; none without any.
std::optional<Extent> extent_at(const Animation& animation, double seconds);

/// Box of the film by five instants; its duration is set.
std::optional<Extent> extent_of_film(const Animation& animation);

/// Box of the middle 98 % of triangle centres along each axis, without ground and backdrop. Needs triangles.
Extent detailed_extent_at(const Animation& animation, double seconds);

/// Limit of coordinates: Embree takes none beyond 1.8e19.
inline constexpr double farthest = 1e18;

/// World positions of an object in file space; empty where it is hidden or beyond `farthest`.
std::vector<glm::dvec3> world_positions(const Animation& animation, const Object& object, const struct Pose& pose);

/// World positions of the corners of a volume's box; likewise, and empty where it has none.
std::vector<glm::dvec3> world_corners(const Volume& volume, const struct Pose& pose);

}  // namespace render2mpeg::scene
