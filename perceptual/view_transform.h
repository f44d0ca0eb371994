#pragma once
// Blender's views: signals of exposed light, their slope, and their inverse for grey.
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

/// A view other than `neutral`: mix channels, curve, mix again, gamma (docs/model/display.md). Signals are sRGB code
/// values over 255. Immutable and thread-safe.
class ViewTransform {
  public:
    /// A view of the name `neutral` is a broken contract.
    explicit ViewTransform(const core::View& view);

    /// Of exposed scene-linear light. Negative light and NaN count as none.
    glm::vec3 signals(glm::vec3 exposed) const;
    ShownLight show(glm::vec3 exposed) const;

    /// The grey light with this signal in [0, 1]: of 0 the most that is black, of 1 the least that is white.
    double grey_light(double signal) const;

  private:
    using Table = CurveTable<-13, 6>;

    /// The light that the curve gets, and its derivative by the logarithm of the light, over itself.
    ShownLight mix(glm::vec3 exposed) const;
    float falls(float mixed) const;

    core::View view_;
    double white_;     ///< the least light that the curve makes 1
    float end_slope_;  ///< of the curve by the logarithm of the light, at `white_`
    Table table_;
};

}  // namespace render2mpeg::perceptual
