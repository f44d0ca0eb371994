#pragma once
// Views other than `neutral`: signals of exposed light, their slope, and their inverse.
#include <glm/glm.hpp>

#include "core/view.h"
#include "perceptual/curve_table.h"

namespace render2mpeg::perceptual {

/// Signals R', G', B' in [0, 1].
struct ShownLight {
    glm::vec3 signal;
    /// Derivative by the logarithm of the light, its colour kept. Where a channel is clipped at white it limits
    /// tolerances (docs/model/display.md).
    glm::vec3 log_slope;
};

/// A view other than `neutral`: mix channels, curve, mix again, gamma (docs/model/display.md). Signals of Blender's
/// views are sRGB code values over 255, those of `pq` and `hlg` [BT2100]'s with the primaries of [BT2020]. Immutable
/// and thread-safe.
class ViewTransform {
  public:
    /// A view of the name `neutral` is a broken contract.
    explicit ViewTransform(const core::View& view);

    const core::View& view() const { return view_; }

    /// Of exposed scene-linear light. Negative light and NaN count as none.
    glm::vec3 signals(glm::vec3 exposed) const;
    ShownLight show(glm::vec3 exposed) const;

    /// The grey light with this signal in [0, 1]: of 0 the most that is black, of 1 the least that is white.
    double grey_light(double signal) const;

    /// What a display of the view `pq` shows, in cd/m^2 by channel. Of other views a broken contract.
    glm::vec3 luminances(glm::vec3 exposed) const;
    /// What signals in [0, 1] of `pq` and `hlg` make a display show, over reference white, with BT.709's primaries: the
    /// exposed light but for what the tone curve bent. Some of it may be negative by what was rounded. Of other views a
    /// broken contract.
    glm::vec3 shown_light(glm::vec3 signals) const;

  private:
    // chosen: 2^-24 of white is 1e-5 cd/m^2 in `pq`, a tenth of a code value above black
    using Table = CurveTable<-24, 12>;

    /// The light that the curve gets, and its derivative by the logarithm of the light, over itself.
    ShownLight mix(glm::vec3 exposed) const;
    float falls(float mixed) const;

    core::View view_;
    double white_;     ///< the least light that the curve makes 1, or holds for the brightest
    float end_slope_;  ///< of the curve by the logarithm of the light, at `white_`
    Table table_;
};

}  // namespace render2mpeg::perceptual
