#pragma once
// A rough look at a frame before it is lit, for the first tolerances.
#include "core/radiance.h"
#include "renderer/renderer.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

/// What a frame looks like, roughly: one pixel in 4x4 is lit, coarsely, and its light interpolated along surfaces and
/// multiplied by their textures. For the eye's tolerances where there is no frame before to ask: about a fortieth of
/// the work of lighting the frame. Counts in the renderer's statistics as time and as
/// an update of light only.
core::Radiance preview(renderer::Renderer& renderer, const scene::Snapshot& world, const renderer::Seen& seen);

}  // namespace render2mpeg::app
