#pragma once
// Adds what moving objects change of cached light.
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Adds to the exact light of all points what moving objects change (light_split.h): gathered on a lattice of points,
/// and interpolated between them where it changes little. Points whose light it makes so much darker that they were lit
/// too roughly are lit again. Only where light is split.
void add_dynamic_light(FrameState& frame);

}  // namespace render2mpeg::renderer
