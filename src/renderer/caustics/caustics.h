#pragma once
// Light that comes to gather points by way of mirrors and glass.
#include <cstdint>
#include <span>

#include "core/archive.h"
#include "core/tolerance_map.h"
#include "renderer/base/light_point.h"
#include "renderer/caustics/splat_tree.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/surface/ungathered_light.h"

namespace render2mpeg::renderer {

struct CausticSettings {
    std::uint64_t photons = 0;           ///< 0: as many as the tolerance needs
    bool rays_see_sky_in_panes = false;  ///< Plan's: photons bring what of it is too bright for rays
    SplatVisibility visibility = SplatVisibility::by_rays;
};

/// Budget for caustics of the frames of a chunk.
struct CausticBudget {
    std::uint64_t photons = 0;  ///< 0: not known yet
    float dim = 0;              ///< irradiance of a landing below which it stands for several
    bool visible = true;        ///< false: what there is would not be seen
};

/// Costs of caustics, summed over frames.
struct CausticCounts {
    LandingCounts followed;
    std::uint64_t landings = 0;
    SplatCounts splats;
};

/// All light that comes from lamps to gather points by mirrors, metal and bent glass alone (L S+ D, then the eye's own
/// way), by photon ray splatting (docs/model/caustics.md). How many photons a frame has is decided at the first frame
/// of a chunk.
class Caustics {
  public:
    explicit Caustics(const CausticSettings& settings = {}) : settings_(settings) {}

    /// A chunk begins.
    void forget() { budget_ = {}; }

    /// Adds caustics to `light`. `lights`: all light points of the posed instant. `tolerance`: of the frame; null: a
    /// rough look that teaches nothing.
    void add(const PosedScene& posed_scene, std::span<const LightPoint> lights, const core::ToleranceMap* tolerance,
             const Frame& seen, UngatheredLight& light, CausticCounts& counts);

    const CausticBudget& budget() const { return budget_; }

    template <class A>
    friend void archive(A& a, Caustics& caustics) {
        auto& [settings, budget] = caustics;
        a(budget);
    }

  private:
    CausticSettings settings_;
    CausticBudget budget_;
};

}  // namespace render2mpeg::renderer
