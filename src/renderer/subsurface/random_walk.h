#pragma once
// Where light enters that leaves at a point: a random walk below the surface.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "renderer/base/stream.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Share of light that a medium scatters on, for which a half space reflects `albedo` of diffuse light; both 0..1.
/// [vanDeHulst1980]
float scattering_albedo(float albedo);

/// A place where light enters that leaves at `point`, which is `below` (SurfacePoint), after a walk within its object
/// [Chiang2016SSS]: a Lambert surface that has the walk's share; in the mean over `number` they are all of it. None
/// where the walk ends inside.
std::optional<SurfacePoint> random_walk(const PosedScene& posed_scene, const SurfacePoint& point,
                                        const Stream& numbers);

}  // namespace render2mpeg::renderer
