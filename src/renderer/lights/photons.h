#pragma once
// Traces photons from the lights through the posed scene.
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.h"
#include "renderer/base/light_point.h"
#include "renderer/lights/photon_source.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

struct PhotonSettings {
    std::uint64_t first_path = 1;  ///< index into the Halton sequence; the same in every frame
    std::uint64_t paths = 0;
    int bounces = 0;                        ///< places where one path may leave a VPL; 0: any number
    std::span<const LightPoint> planned{};  ///< PhotonSource
};

struct PhotonResult {
    std::vector<LightPoint> vpls;  ///< in the order of paths and bounces; ids are hashes of both, hardly ever alike
    std::uint64_t rays = 0;
    double landed = 0;  ///< flux that met scattering surfaces, luminance, summed over bounces
    double lost = 0;    ///< of it, what largest_albedo kept from going on
};

/// Follows `paths` photons from the lights through the posed scene and leaves a virtual point light wherever one meets
/// a surface that scatters it: intensity rho / pi dPhi on the side that was hit [Render2MPEG, eq. 6.3]. Photon i takes
/// the same numbers whatever the scene. Paths end by Russian roulette alone, which loses no light up to largest_albedo.
/// Does not depend on the number of threads.
PhotonResult trace_photons(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                           const PhotonSettings& settings);

/// The world as its objects lie now: the film's box at its start, and whatever moves.
core::Box world_box(const scene::Snapshot& snapshot);

/// How many paths leave about `vpls` VPLs in the posed scene; 0 where no light reaches any surface.
std::uint64_t paths_for(const PosedScene& posed_scene, std::span<const LightPoint> lights, int vpls, int bounces);

}  // namespace render2mpeg::renderer
