#pragma once
// The steps of posing a film that a snapshot and its sweep share.
#include <cstdint>
#include <vector>

#include "scene/pose/pose.h"
#include "scene/pose/sweep.h"

namespace render2mpeg::scene {

/// Poses one object; adds to `deformed` where its vertices move one by one.
ObjectState pose_object(const Animation& animation, const Object& object, const Pose& pose,
                        std::vector<DeformedMesh>& deformed);

/// A camera's place without its scale; mirrored and sheared nodes keep the direction of sight and the side that is up.
glm::mat4 rigid(const glm::dmat4& to_world, glm::dvec3 origin);

/// The camera of a frame: the last shot that began; before the first, the first.
int camera_at(const Animation& animation, std::int64_t frame);

/// The part of the shutter's time that lies in the frame's shot, whose frames reach half a frame to each side; its
/// middle stays.
ShutterInterval within_shot(const Animation& animation, std::int64_t frame, const ShutterInterval& shutter);

/// Finds what moves while the shutter is open about a snapshot, whose pose is this; gives light its mean.
void find_sweep(Snapshot& snapshot, const Pose& pose, int camera, const ShutterInterval& shutter);

}  // namespace render2mpeg::scene
