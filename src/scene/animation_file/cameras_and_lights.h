#pragma once
// Cameras and shots of an animation file.
#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Puts the file's cameras before those of the scene: one under `camera`, or several by name under `cameras`.
void read_cameras(const JsonValue& film_value, Animation& film, const FilmClock& clock);

/// Focuses cameras on the objects that they name, once all are read.
void focus_on_objects(const JsonValue& film_value, Animation& film);

/// Which camera the film shows from when on. Cameras of the scene file can be named too.
void read_shots(const JsonValue& shots, Animation& film, const FilmClock& clock);

/// Adds the lights of the key `lights`: punctual ones, and panels and spheres, which are objects that shine.
void read_lights(const JsonValue& lights, Animation& film, const FilmClock& clock);

}  // namespace render2mpeg::scene
