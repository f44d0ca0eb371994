#pragma once
// The tone curve by itself, and with sRGB's curve.
#include "perceptual/curve_table.h"

namespace render2mpeg::perceptual {

/// Tone curve from exposed light >= 0 to display-linear [0, 1] (docs/model/display.md).
double tone_curve(double exposed);
/// Its inverse, for display-linear values in [0, 1).
double inverse_tone_curve(double display_linear);

/// It and core::linear_to_srgb in one table, right to 1e-4 code values (test), a tenth of float luma's resolution. A
/// straight line below 2^-9; 6e-5 code values below white at 2^18.
class SignalCurve : public CurveTable<-9, 18> {
  public:
    /// The only one; built at first use.
    static const SignalCurve& instance();

  private:
    SignalCurve();
};

}  // namespace render2mpeg::perceptual
