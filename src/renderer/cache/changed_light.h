#pragma once
// Records follow light that changes (docs/model/irradiance-cache.md).
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Takes records over to an instant whose light is another, or whose things lie elsewhere, before its frame is lit:
/// the first rays of each record that the picture shows are traced again, and what they find otherwise than before is
/// a control variate [Rousselle2016]. A record's light becomes that of before, times a factor, plus the local
/// regression of what its neighbours' rays find beyond that; its `ray_count` becomes that of independent rays that
/// would err as much. Records of surfaces that are gone, and those beyond the picture, are dropped.
void follow_light(FrameState& frame);

}  // namespace render2mpeg::renderer
