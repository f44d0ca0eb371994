#pragma once
// Quality of decoded pictures, summed over a film.
#include "app/experiments/trial.h"

namespace render2mpeg::app {

struct Quality {
    double psnr_y = 0, ssim_y = 0;  ///< dB, +infinity where nothing differs; 1 likewise
    double psnr_hvs_m = 0;          ///< dB, likewise
};

/// Quality against reference light: coding errors of all pictures (`shown`), plus the error that light adds on the
/// reference frames (`decoded` against `there`).
Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded);

/// Quality of the sample, against references where there are any, else against its lit pictures. PSNR-HVS-M needs
/// Trials::mask_all.
Quality quality_of(const Trial& trial, bool against_references);

}  // namespace render2mpeg::app
