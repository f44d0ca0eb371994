#pragma once
// Completes a loaded film: checks, repairs, default light and camera.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Checks everything that the rest of the program relies on (indices, finite numbers, no cycles, rising keys, sizes
/// that agree) and throws core::Error with file, object and cause; drops triangles that cannot be drawn; sets origin,
/// bounds, mobility and duration; gives a film without camera one, and one without light a light (default_light.h; not
/// if `default_light` is false). Idempotent.
void complete(Animation& animation, bool default_light = true);

}  // namespace render2mpeg::scene
