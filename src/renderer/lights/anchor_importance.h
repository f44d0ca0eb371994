#pragma once
// How important a place is for light that cameras see.
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/surface/posed_scene.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Picture format of the cameras that importance is judged by: few rays serve.
inline constexpr scene::PictureFormat importance_format{24, 14, 1.0f};

/// How much of the light that leaves each of these places reaches what the camera of the posed instant sees: the root
/// of its share of their mean, at least a half; all 1 where the camera sees no surface. The root, since what errs is
/// light times the size of its cell: fewest errors in sum come of cells that shrink as it. The snapshot's camera is
/// made for `importance_format`.
std::vector<float> importance_to_eye(const PosedScene& posed_scene, std::span<const LightPoint> places);

}  // namespace render2mpeg::renderer
