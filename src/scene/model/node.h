#pragma once
// Turns of nodes: matrices taken apart, and looking towards a point.
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Turns a node's matrix, if it has one, into translation, rotation and scale, so that tracks can move it. Shear is
/// lost.
void separate(Node& node);

/// The turn that takes -z to `forward` and +y as near to `up` as it can be. No turn where `forward` has no direction.
glm::dquat turn_towards(glm::dvec3 forward, glm::dvec3 up);

}  // namespace render2mpeg::scene
