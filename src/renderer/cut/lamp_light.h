#pragma once
// Light of area lamps: closed form times the share of the lamp that shadow rays see.
#include "renderer/base/area_lamp.h"
#include "renderer/cut/shadow_tester.h"
#include "renderer/cut/stopping_rule.h"

namespace render2mpeg::renderer {

/// Contribution of a lamp of unit radiance to the lanes, visibility included.
struct LampLight {
    LightLanes unit;
    LayerTint tint;             ///< unset where nothing is translucent
    alignas(64) Lanes error{};  ///< standard error, luminance of the lanes' pixels; 0 where all samples were asked for

    UnitLight visible(const GatherLanes& lanes, bool translucent) const {
        UnitLight light = unit_light(lanes, unit);
        if (translucent) light.passes = tint.passes;
        return light;
    }
};

/// How well a lamp must be sampled.
struct LampAccuracy {
    const GroupTolerance* tolerance = nullptr;  ///< null: by all samples
    const Lanes* luminance = nullptr;           ///< of the lanes so far
    bool one_point = false;                     ///< by all samples; all lanes are one point, and share them
    LaneShadows* shadows = nullptr;             ///< as of ShadowTester::trace_from_places
};

/// A lamp's light in the lanes of a group [Szecsi2004]: J, the irradiance without occlusion, times the share of
/// samples' weight that is visible, and the lobes' response to the samples in the same way. Each lane begins with four
/// stratified samples of its own, and takes twice as many, up to 1,024, as long as the share may still be off by more
/// than a part of the lane's tolerance. Where samples have a price a lane begins with one, and goes on while they are
/// fewer than they are worth.
void gather_lamp(const AreaLamp& lamp, const GatherLanes& lanes, bool translucent, const LampAccuracy& accuracy,
                 ShadowTester& shadows, LampLight& out);

}  // namespace render2mpeg::renderer
