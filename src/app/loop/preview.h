#pragma once
// A rough look at a frame before it is lit, for the first tolerances.
#include "core/radiance.h"
#include "renderer/renderer.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

/// Rough look at a frame for its first tolerances: one pixel in 4x4 is lit coarsely, and light interpolated along
/// surfaces; a fortieth of the frame's work. The renderer counts time and an update of light only.
core::Radiance preview(renderer::Renderer& renderer, const scene::Snapshot& world, const renderer::Seen& seen);

}  // namespace render2mpeg::app
