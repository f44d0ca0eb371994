#pragma once
// The tone curve and transfer function by themselves.
#include "perceptual/curve_table.h"

/// Tone curve and transfer function, each with its inverse, and tabulated as one.
namespace render2mpeg::perceptual {

/// The display's tone curve by itself: scene-linear, exposed, >= 0, to display-linear in [0, 1]
/// (docs/model/display.md).
double tone_curve(double exposed);
/// Its inverse, for display-linear values in [0, 1).
double inverse_tone_curve(double display_linear);

/// Display-linear light in [0, 1] to the signal R', G' or B' in [0, 1], and back. [BT709, 1.2] with the constants that
/// make value and slope continuous [BT2020, table 4].
double opto_electronic(double display_linear);
double inverse_opto_electronic(double signal);

/// Tone curve and transfer function in one, tabulated: exposed scene-linear light to signal. Right to 1e-4 code values
/// of 219 (test), which is below what float luma resolves twice over. Below 2^-6 it is the straight line 4.5 x, which
/// ends at 0.018; at 2^18 it is 6e-5 code values below white.
class SignalCurve : public CurveTable<-6, 18> {
  public:
    /// The only one; built at first use.
    static const SignalCurve& instance();

  private:
    SignalCurve();
};

}  // namespace render2mpeg::perceptual
