#pragma once
// Lights a film that has no light.
#include <string>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Lights a film that has no light at all, and returns one line that says how: by a neutral sky; or, where the first
/// camera is closed in at `seconds` so that no sky could reach it, by the surface that closes everything in (a sky
/// dome, a room), or else by a lamp at the camera. Needs a film that is valid otherwise and has a camera.
std::string add_default_light(Animation& animation, double seconds);

}  // namespace render2mpeg::scene
