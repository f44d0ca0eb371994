#pragma once

#include <cmath>

#include "perceptual/display.h"
#include "perceptual/signal_curve.h"

namespace render2mpeg::perceptual {

/// Unrounded luma in code values, 16..235, of one radiance on a display: what Display::develop makes of a pixel.
inline float luma_of(const Display& display, glm::vec3 radiance) {
    const SignalCurve& curve = SignalCurve::instance();
    const glm::vec3 c = radiance * std::exp2(display.exposure());
    return 16.0f + 219.0f * glm::dot(luma_weights(display.matrix()),
                                     glm::vec3{curve.signal(c.x), curve.signal(c.y), curve.signal(c.z)});
}

}  // namespace render2mpeg::perceptual
