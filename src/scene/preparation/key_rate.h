#pragma once

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Sets the frame rate of a film that does not say one, where all of its keys lie on frames of one rate, and says so.
/// 25 is set no more than none: it is what films have anyway.
void suggest_rate(Animation& animation);

}  // namespace render2mpeg::scene
