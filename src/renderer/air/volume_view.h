#pragma once
// Light of volumes as the eye sees it.
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/surface/ungathered_light.h"

namespace render2mpeg::renderer {

/// Adds the light of volumes that each pixel shows, by rays through it. `posed_scene`: its volumes are lit.
void add_volumes_seen(const PosedScene& posed_scene, const Frame& seen, EffectLight& light);

}  // namespace render2mpeg::renderer
