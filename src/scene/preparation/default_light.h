#pragma once
// Lights a film that has no light.
#include <string>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"
#include "scene/pose/extent.h"
#include "scene/preparation/framing.h"

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

/// Whether anything lights the film. Surfaces that glow by a picture, no brighter than white, do not: they are screens
/// and eyes, which shine on nothing.
bool has_light(const Animation& animation);

/// Lights a film that has no light at all, and returns one line that says how: by a studio or a neutral sky; or, where
/// the first camera is closed in at `seconds` so that no sky could reach it, by the surface that closes everything in
/// (a sky dome, a room), or else by a lamp at the camera. A studio has a floor where the camera looks on from outside,
/// and is a neutral sky where it looks into an open side (`view` of an automatic camera). Needs a film that is valid
/// otherwise and has a camera.
std::string add_default_light(Animation& animation, double seconds, DefaultLight kind, View view);

}  // namespace render2mpeg::scene
