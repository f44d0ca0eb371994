#pragma once
// Checks and repairs a loaded film.
#include "scene/model/animation.h"

/// Checks of `complete`: throw core::Error with file, object and cause, or repair and note it in Animation::notes.
namespace render2mpeg::scene {

/// Nodes: parents exist, no cycles, finite transforms, unit rotations.
void validate_nodes(Animation& animation);

/// Targets, number and order of keys, finite values. Of simultaneous keys the last stays.
void validate_tracks(Animation& animation);

/// Array sizes, indices, finite corners; drops flat triangles, normalises normals.
void validate_meshes(Animation& animation);

/// References of objects and skins; drops empty and invisible objects.
void validate_objects(Animation& animation);

/// Materials, images and sky: finite, in range.
void validate_looks(Animation& animation);

/// Cameras, lights and shots.
void validate_cameras(Animation& animation);
void validate_lights(Animation& animation);

/// Volumes: numbers, files and their heads; sets their boxes.
void validate_volumes(Animation& animation);

/// Edits of reflections, as all stands at the film's first second: each has a mirror, and its point lies on that alone.
/// Needs a film that is complete otherwise.
void validate_reflections(const Animation& animation, core::Rational first);

bool varies(const Track& track);

/// Per node: whether a track moves or switches it or an ancestor.
std::vector<char> moving_nodes(const Animation& animation);

}  // namespace render2mpeg::scene
