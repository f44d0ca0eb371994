#pragma once
// Gives a film without cameras one that shows it.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Gives a film without cameras one that shows it (two nodes, a lens and a track), and returns one line that says what
/// it does. Needs a film that is valid otherwise.
std::string add_automatic_camera(Animation& animation);

}  // namespace render2mpeg::scene
