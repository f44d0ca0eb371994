#include "perceptual/signal_curve.h"

#include <algorithm>

#include "core/color.h"

namespace render2mpeg::perceptual {
namespace {

// The shoulder is that of the Khronos neutral tone mapper [KhronosNeutral], 1 - d^2 / (x + d - knee) with d = 1 - knee,
// which equals knee + d u / (1 + u) with u = (x - knee) / d. We apply it to each channel, so that it has an inverse per
// channel and bright colours fade to white; and leave out its darkening offset and its own desaturation.
//
// chosen: 0.625 of 0.5 to 0.8 (docs/measurements.md#pictures). A dyadic number, so that the knee is a segment's border
// in SignalCurve.
constexpr double knee = 0.625;

}  // namespace

double tone_curve(double exposed) {
    if (!(exposed > knee)) return std::max(exposed, 0.0);
    const double d = 1.0 - knee;
    return 1.0 - d * d / (exposed + d - knee);
}

double inverse_tone_curve(double display_linear) {
    if (!(display_linear > knee)) return std::max(display_linear, 0.0);
    const double d = 1.0 - knee;
    return d * d / (1.0 - display_linear) - d + knee;
}

const SignalCurve& SignalCurve::instance() {
    static const SignalCurve curve;
    return curve;
}

SignalCurve::SignalCurve()
    : CurveTable([](double exposed) { return core::linear_to_srgb(tone_curve(exposed)); }, core::srgb_slope_at_black) {}

}  // namespace render2mpeg::perceptual
