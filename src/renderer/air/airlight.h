#pragma once
// Light that fog scatters towards the eye, for all pixels of a frame.
#include <cstdint>
#include <span>

#include "core/tolerance_map.h"
#include "renderer/air/air_lamp.h"
#include "renderer/air/ambient_air.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Adds the light of the air that each pixel shows to what needs no gathering. The scene has air. It is found along a
/// lattice of rays, finer where it changes, and interpolated between them at each pixel's own distances. Returns the
/// shadow rays. `ambient`: of the posed instant; learns. The same for any number of threads. `tolerance`: the frame's; null: for a rough look.
std::uint64_t add_airlight(const PosedScene& posed_scene, std::span<const AirLamp> lamps, Bodies bodies,
                           AmbientAir& ambient,
                           const core::ToleranceMap* tolerance, Seen& seen);

}  // namespace render2mpeg::renderer
