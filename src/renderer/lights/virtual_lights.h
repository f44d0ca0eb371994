#pragma once
// Virtual point lights: indirect light as light points, left by photons of fixed numbers.
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/lights/photons.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Light points of an instant, and the same as bright as their photons are planned by: where lamps flicker, photons
/// then go the same ways. Those that do not shine now are dark.
struct PlannedLights {
    std::vector<LightPoint> shining, planned;

    /// `average`: LightPoints::average.
    PlannedLights(std::span<const LightPoint> now, std::span<const LightPoint> average);
};

/// Number of VPLs and of the paths that leave them.
struct VirtualLightSettings {
    int vpls = 32768;         ///< about, at an average instant; no instant has more than four times as many, about
    int bounces = 0;          ///< see PhotonSettings
    std::uint64_t paths = 0;  ///< virtual_light_paths
};

/// Paths that every instant of a chunk follows: as many as leave the VPLs wanted at the posed instant by these lights,
/// and as many as those where none lands: light may come later.
std::uint64_t virtual_light_paths(const PosedScene& posed_scene, std::span<const LightPoint> average, int vpls,
                                  int bounces);

/// The VPLs of the posed instant, each with the disc of surface that its light spreads over (docs/model/lights.md). One
/// stays as it was, id and all, where nothing on its path and about it changed. Does not depend on the number of
/// threads.
PhotonResult virtual_lights(const PosedScene& posed_scene, const PlannedLights& lights,
                            const VirtualLightSettings& settings);

/// Gives light points of surfaces their discs: of each its share, by intensity, of the circle through its nearest
/// neighbours that face alike; `alone` is the area where there is no other.
void spread(std::span<LightPoint> points, float alone);

}  // namespace render2mpeg::renderer
