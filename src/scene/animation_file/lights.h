#pragma once
// Lights of an animation file.
#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Adds the lights of the key `lights`: punctual ones, and panels and spheres, which are objects that shine.
void read_lights(const JsonValue& lights, Animation& film, const FilmClock& clock);

}  // namespace render2mpeg::scene
