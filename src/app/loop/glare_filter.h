#pragma once
#include <optional>

#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/archive.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "perceptual/glare.h"

namespace render2mpeg::app {

/// Light as an eye gets it: with glare, where that runs. Coding and visibility use it; layers and OpenEXR frames have
/// the scene's own light.
class GlareFilter {
  public:
    /// An unknown exposure counts as 0 EV.
    GlareFilter(const RenderJob& film, RunStatistics& statistics);

    /// `light` itself without glare, else its `combined` and `frame`, valid until the next call.
    const core::Radiance& of(const core::Radiance& light, const core::Rational& seconds);

    /// From tolerances of shown light to those of light: the veil's share of the background is taken off.
    void carry_back(core::ToleranceMap& tolerance) const;

    template <class A>
    friend void archive(A& a, GlareFilter& filter) {
        auto& [glare, veil, statistics, shown] = filter;
        a(veil);
    }

  private:
    std::optional<perceptual::Glare> glare_;
    core::Plane<float> veil_;  ///< luminance; empty: none was shown
    RunStatistics& statistics_;
    core::Radiance shown_;
};

}  // namespace render2mpeg::app
