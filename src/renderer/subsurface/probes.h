#pragma once
// Where light enters that leaves at a point.
#include <cstdint>
#include <optional>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// A place where light enters that leaves at `point`, which is `below` (SurfacePoint): of all that probes meet of the
/// same object [King2013], along rays through discs across the normal and both tangents as far as the material's light
/// reaches, one by chance. A Lambert surface whose reflectance has its share of what leaves; in the mean over `number`
/// they are all of it. None where probes meet nothing.
std::optional<SurfacePoint> probe(const PosedScene& posed_scene, const SurfacePoint& point, std::uint64_t number);

}  // namespace render2mpeg::renderer
