#pragma once
// The light of a film's frames as an eye gets it.
#include <optional>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "perceptual/glare.h"

namespace render2mpeg::app {

/// The light of a film's frames as an eye gets it: with glare, where that runs. What is coded, and what the visibility
/// model judges, is this light; layers and OpenEXR frames have the scene's own.
class ShownLight {
  public:
    /// The film's exposure is known, or counts as 0 EV.
    ShownLight(const RenderJob& film, RunStatistics& statistics);

    /// `light` itself where there is no glare, else only its `combined` and `frame`, valid until the next call.
    const core::Radiance& of(const core::Radiance& light, const core::Rational& seconds);

    /// From tolerances of what is shown to those of the light itself: what the veil over the frame shown last gives a
    /// pixel, its own light need not, so that all of a tolerance is left for the rest.
    void carry_back(core::ToleranceMap& tolerance) const;

  private:
    std::optional<perceptual::Glare> glare_;
    core::Plane<float> veil_;  ///< luminance; empty: none was shown
    RunStatistics& statistics_;
    core::Radiance shown_;
};

}  // namespace render2mpeg::app
