#pragma once

#include <cstddef>
#include <vector>

#include "renderer/surface/posed_scene.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// At most `count` points spread evenly by area over the fronts of all surfaces that never move (and backs of what has
/// two sides), as far as they scatter light and are open to some [Render2MPEG, 7.3.1]: where light may arrive that no
/// photon was seen to bring. A function of the posed instant's still surfaces and `count` alone. Looks twice at every
/// triangle.
std::vector<SurfacePoint> even_points(const PosedScene& posed_scene, std::size_t count);

}  // namespace render2mpeg::renderer
