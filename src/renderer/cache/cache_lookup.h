#pragma once
// Lights a frame's points: by the cache, else by gathering.
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Lights the points of a lattice whose light is not known: by the cache; where that cannot, by gathering, which makes
/// records for the points after them.
void light_lattice(FrameState& frame, int lattice);

/// Lights all points whose light is not known, lattice by lattice.
void light_points(FrameState& frame);

}  // namespace render2mpeg::renderer
