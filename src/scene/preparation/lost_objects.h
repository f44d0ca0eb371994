#pragma once
// Tells which objects no film can show, by where and how large they are.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Notes the first object, and the number of others, whose scale is 0 along an axis at five instants of the film from
/// `start` (seconds) on, and those too small for single precision as far away as they are. Needs duration and origin.
void note_lost_objects(Animation& animation, double start);

}  // namespace render2mpeg::scene
