#pragma once
// Anchor lights: VPLs at fixed places whose intensities follow the photons.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/photon_splat.h"
#include "renderer/lights/photons.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

struct AnchorSettings {
    int count = 4096;  ///< anchors in all, about; at least one for every surface that moves
    int bounces = 0;   ///< see PhotonSettings
    std::uint64_t photons =
        0;  ///< VPLs that are splatted onto the anchors in a frame, about; 0: as many as `count` asks for
};

/// Places that are looked at to choose so many anchors: most of the memory that anchors ever take is theirs.
std::uint64_t candidates_for(std::uint64_t anchors);

/// Anchor lights: the virtual point lights (VPLs) of indirect light, a constant number at places that are fixed on
/// their surfaces for the whole film. Every instant's photons are splatted onto them (docs/model/lights.md). Those of
/// surfaces that move are carried along by them. A function of the animation and the settings alone.
class Anchors {
  public:
    /// Chooses the places. `posed_scene` gets posed at instants of the film and is posed as before at the end; `lights`
    /// is placed anew for the film's beginning.
    Anchors(PosedScene& posed_scene, LightPoints& lights, const AnchorSettings& settings);
    ~Anchors();
    Anchors(Anchors&&) noexcept;

    /// Anchors averaged over the film, with a little light for all: trees are planned by them.
    std::vector<LightPoint> average_still() const;
    std::vector<LightPoint> average_moving() const;

    /// Photons that every instant follows: as many as leave what the settings ask for at the average instant, but no
    /// more than 64 for each anchor, however few of them meet anything.
    std::uint64_t paths() const;

    /// Rays that the choice took.
    std::uint64_t rays() const;

    /// Bytes held between instants.
    std::size_t bytes() const;

    struct Lit {
        std::vector<LightPoint> still, moving;  ///< by id; dark ones among them
        std::uint64_t rays = 0;
        double landed = 0, lost = 0;  ///< see PhotonResult, of all photons
        OccludedNeighbours occluded;
    };
    /// The anchors as `lights` let them shine at the posed instant. All light that photons leave on surfaces is in
    /// them. Does not depend on the number of threads.
    Lit at(const PosedScene& posed_scene, std::span<const LightPoint> lights) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace render2mpeg::renderer
