#pragma once

#include <vector>

#include "renderer/light_point.h"

namespace render2mpeg::renderer {

/// Gives every VPL the disc of surface that it stands for (LightPoint::disc2): its intensity over the radiance of the
/// surface about it, which is estimated from the nearest VPLs that face the same way (docs/model.md, "Clamping").
/// Scales with the scene, shrinks with the number of VPLs, and depends on nothing but them.
void estimate_discs(std::vector<LightPoint>& vpls);

}  // namespace render2mpeg::renderer
