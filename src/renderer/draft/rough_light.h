#pragma once
// Rough light from every fourth pixel.
#include "core/radiance.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/ungathered_light.h"

namespace render2mpeg::renderer {

/// The frame with gather points in one pixel of 4x4 alone.
Frame every_fourth_pixel(Frame frame);

/// Fills the pixels of `frame` that `every_fourth_pixel` leaves out: light of the lit pixels about them, over their
/// reflectance, interpolated along surfaces and multiplied by their own. About a fortieth of a frame's work.
void interpolate_light(const Frame& frame, const UngatheredLight& ungathered, core::Radiance& radiance);

}  // namespace render2mpeg::renderer
