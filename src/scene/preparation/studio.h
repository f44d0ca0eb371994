#pragma once
// Shows a film without light as product pictures are shown: in a studio.
#include "scene/model/animation.h"
#include "scene/pose/extent.h"

namespace render2mpeg::scene {

/// Height of the studio's camera over what it shows, radians: the floor fills the picture, and tops show as sides do.
inline constexpr double studio_elevation = 0.31;
/// Longest film of a still thing.
inline constexpr double studio_seconds = 4;

/// A studio: a sky of soft boxes over an even backdrop, a soft sun from the left of a camera that looks along
/// `forward`, a weaker one from behind on the right, and, where there is a `floor` below what is in `extent`, a matt
/// one that catches shadows and fades into the backdrop (Animation::stage). White that faces the light has a radiance
/// of about 1. Needs a valid film.
void add_studio(Animation& animation, const Extent& extent, glm::dvec3 forward, bool floor);

}  // namespace render2mpeg::scene
