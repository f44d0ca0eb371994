#pragma once
// The tone curve and transfer function by themselves.
#include "perceptual/curve_table.h"

namespace render2mpeg::perceptual {

/// Tone curve from exposed light >= 0 to display-linear [0, 1] (docs/model/display.md).
double tone_curve(double exposed);
/// Its inverse, for display-linear values in [0, 1).
double inverse_tone_curve(double display_linear);

/// Display-linear light in [0, 1] to a signal, and back [BT709, 1.2], with constants for a continuous slope [BT2020,
/// table 4].
double opto_electronic(double display_linear);
double inverse_opto_electronic(double signal);

/// Both in one table, right to 1e-4 code values (test), a tenth of float luma's resolution. A line of slope 4.5 below
/// 2^-6; 6e-5 code values below white at 2^18.
class SignalCurve : public CurveTable<-6, 18> {
  public:
    /// The only one; built at first use.
    static const SignalCurve& instance();

  private:
    SignalCurve();
};

}  // namespace render2mpeg::perceptual
