#pragma once
// Turns of nodes: matrices taken apart, and looking towards a point.
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Replaces a node's matrix by translation, rotation and scale; shear is lost.
void separate(Node& node);

/// Turns -z to `forward` and +y towards `up`. Identity without a direction.
glm::dquat turn_towards(glm::dvec3 forward, glm::dvec3 up);

}  // namespace render2mpeg::scene
