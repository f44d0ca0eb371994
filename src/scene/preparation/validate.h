#pragma once
// Checks and repairs a loaded film.
#include "scene/model/animation.h"

/// The steps of `complete` that check: each throws core::Error with file, object and cause for what cannot be used,
/// repairs what can, and says so in Animation::notes.
namespace render2mpeg::scene {

/// Nodes: parents exist, no cycles, finite transforms, unit rotations.
void validate_nodes(Animation& animation);

/// Tracks: their targets exist, as many values as keys ask for, finite, times that rise. Of keys at one time the last
/// stays.
void validate_tracks(Animation& animation);

/// Meshes: arrays of one size, indices in range. Triangles with a corner that is not finite or without area are
/// dropped, normals made unit.
void validate_meshes(Animation& animation);

/// Objects and skins: what they refer to exists and fits. Objects without a triangle are removed, and those that nobody
/// can see since their alpha is 0.
void validate_objects(Animation& animation);

/// Materials, images and sky: finite, in range.
void validate_looks(Animation& animation);

/// Cameras, lights and shots.
void validate_cameras(Animation& animation);
void validate_lights(Animation& animation);

/// Whether a track has different values at different times.
bool varies(const Track& track);

/// Per node: whether a track moves, turns, scales or switches it or a node above it.
std::vector<char> moving_nodes(const Animation& animation);

}  // namespace render2mpeg::scene
