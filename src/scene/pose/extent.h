#pragma once
// Bounding boxes in double precision.
#include <glm/glm.hpp>
#include <optional>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// A box in the file's own space, in double precision.
struct Extent {
    glm::dvec3 low{0}, high{0};

    glm::dvec3 centre() const { return low + 0.5 * (high - low); }
    double radius() const { return 0.5 * glm::length(high - low); }
};

/// The box about all triangles that are present at this time; nothing where there are none. Needs a valid film.
std::optional<Extent> extent_at(const Animation& animation, double seconds);

/// The box about all that a film shows, looked at five times. Needs a valid film whose duration is set.
std::optional<Extent> extent_of_film(const Animation& animation);

/// The box about the middle 98 % of the triangles along each axis (by their centres): what is modelled, without the
/// ground and the backdrop around it. Needs a film that has triangles at this time.
Extent detailed_extent_at(const Animation& animation, double seconds);

/// Coordinates beyond this are nowhere: the ray tracer takes none beyond 1.8e19.
inline constexpr double farthest = 1e18;

/// World positions of an object's vertices at a pose, in the file's own space; empty where it is not present or a
/// vertex lies beyond `farthest`.
std::vector<glm::dvec3> world_positions(const Animation& animation, const Object& object, const struct Pose& pose);

}  // namespace render2mpeg::scene
