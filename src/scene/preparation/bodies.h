#pragma once
// Tells which glass bends light, and which is a pane.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Sets Object::body and pane_thickness of every object from its material and its shape as it is posed, by five
/// instants from `start` (seconds) on where that changes; notes solids whose mesh is open. Needs the duration.
void set_bodies(Animation& animation, double start);

}  // namespace render2mpeg::scene
