#pragma once
// Cameras and shots of an animation file.
#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Adds `camera`, or the named `cameras`, before those of the scene.
void read_cameras(const JsonValue& film_value, Animation& film, const FilmClock& clock);

/// Resolves objects that cameras focus on, after these are read.
void focus_on_objects(const JsonValue& film_value, Animation& film);

/// Reads shots; cameras of the scene file count too.
void read_shots(const JsonValue& shots, Animation& film, const FilmClock& clock);

/// Adds `lights`: punctual ones, and panels and spheres, which are objects.
void read_lights(const JsonValue& lights, Animation& film, const FilmClock& clock);

}  // namespace render2mpeg::scene
