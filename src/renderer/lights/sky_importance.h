#pragma once
// Where in the sky the light comes from that cameras see.
#include "image/sky_map.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// The light of a direction over the sphere's mean: how many surfaces that cameras see over the film look there, by
/// their cosines, directly or by one bounce; at least a fifth. Empty where they see none of the sky, or much of it:
/// even parts serve as well then, and lie more evenly. A function of the animation alone, whose instants get posed.
/// `rays` counts those it takes.
image::SkyImportance sky_importance(PosedScene& posed_scene, std::uint64_t& rays);

}  // namespace render2mpeg::renderer
