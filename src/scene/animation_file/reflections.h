#pragma once
// Reflection edits of an animation file: contents of its mirrors.
#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Whether a thing or one of its keys has `reflections`.
bool has_reflections(const JsonValue& thing);

/// Reads `reflections` of a thing and of its keys: edits of the reflections in the objects at `node`. Needs all
/// objects, since edits may name them.
void read_reflections(const JsonValue& thing, int node, Animation& film, const FilmClock& clock);

}  // namespace render2mpeg::scene
