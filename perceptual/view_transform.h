#pragma once
// Blender's views: what they make of exposed light, how that follows the light, and which grey light stands behind it.
#include <glm/glm.hpp>

#include "core/view.h"
#include "perceptual/curve_table.h"

namespace render2mpeg::perceptual {

/// Signals R', G', B' in [0, 1].
struct ShownLight {
    glm::vec3 signal;
    /// Derivative of the signals by the natural logarithm of the light, its colour kept. Where a channel is cut off at
    /// white: what keeps tolerances from letting it fall too far (docs/model/display.md).
    glm::vec3 log_slope;
};

/// A view other than `neutral`, in four steps: channels mix, a curve for each channel, channels mix again, gamma
/// (docs/model/display.md). Steps that a view has not are the identity. Its signals are sRGB code values over 255.
/// Immutable; all functions may run in several threads at once.
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
