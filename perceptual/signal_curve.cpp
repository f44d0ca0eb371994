#include "perceptual/signal_curve.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::perceptual {
namespace {

// The shoulder is that of the Khronos neutral tone mapper [KhronosNeutral], 1 - d^2 / (x + d - knee) with d = 1 - knee,
// which equals knee + d u / (1 + u) with u = (x - knee) / d. We apply it to each channel, so that it has an inverse per
// channel and bright colours fade to white; and leave out its darkening offset and its own desaturation.
//
// chosen: 0.625 of 0.5 to 0.8 (docs/measurements.md#pictures). A dyadic number, so that the knee is a segment's border
// in SignalCurve.
constexpr double knee = 0.625;

// The solutions of alpha x^0.45 - (alpha - 1) = 4.5 x with equal slopes [BT2020, table 4, note]; BT.709 prints them
// as 1.099 and 0.018, which leaves a step of 2e-4.
constexpr double alpha = 1.09929682680944;
constexpr double beta = 0.018053968510807;

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

double opto_electronic(double display_linear) {
    return display_linear < beta ? 4.5 * display_linear : alpha * std::pow(display_linear, 0.45) - (alpha - 1.0);
}

double inverse_opto_electronic(double signal) {
    return signal < 4.5 * beta ? signal / 4.5 : std::pow((signal + (alpha - 1.0)) / alpha, 1.0 / 0.45);
}

const SignalCurve& SignalCurve::instance() {
    static const SignalCurve curve;
    return curve;
}

SignalCurve::SignalCurve() : CurveTable([](double exposed) { return opto_electronic(tone_curve(exposed)); }, 4.5f) {}

}  // namespace render2mpeg::perceptual
