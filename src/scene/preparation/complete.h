#pragma once
// Completes a loaded film: checks, repairs, default light and camera.
#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// Sets the frame rate of a film that does not say one, where all of its keys lie on frames of one rate, and says so.
/// 25 is set no more than none: it is what films have anyway.
void suggest_rate(Animation& animation);

/// Checks everything that the rest of the program relies on (indices, finite numbers, no cycles, rising keys, sizes
/// that agree) and throws core::Error with file, object and cause; drops triangles that cannot be drawn; sets origin,
/// bounds, mobility and duration; gives a film without camera one, and one without light a light as `light`
/// says (default_light.h). Idempotent.
void complete(Animation& animation, DefaultLight light = DefaultLight::even);

}  // namespace render2mpeg::scene
