#pragma once
// Properties of a whole Assimp scene that are determined before anything moves.
#include <glm/glm.hpp>
#include <vector>

#include "scene/model/animation.h"

/// Rest pose of a whole scene, where a format leaves physical facts open.
namespace render2mpeg::scene {

/// Axis 0, 1, 2 (x, y, z), direction -1 or 1.
struct SignedAxis {
    int axis = 0;
    int sign = 1;
};

/// Turns `right` to +x, `up` to +y, `front` to +z; without a right-handed frame, the shortest turn of `up` to +y.
glm::dquat upright(SignedAxis right, SignedAxis up, SignedAxis front);

/// World transforms at rest. Parents come before children.
std::vector<glm::dmat4> rest_transforms(const Animation& animation);

struct RestBounds {
    glm::dvec3 min{0}, max{0};  ///< equal where there is no surface
    glm::dvec3 center() const { return 0.5 * (min + max); }
    double diagonal() const { return glm::length(max - min); }
};

/// Box of all finite vertices.
RestBounds rest_bounds(const Animation& animation, const std::vector<glm::dmat4>& to_world);

/// Makes lamps one-sided where their front is plain: closed meshes outwards, open ones towards the scene's middle.
void settle_sides_of_lamps(Animation& animation, const std::vector<glm::dmat4>& to_world, const RestBounds& bounds);

}  // namespace render2mpeg::scene
