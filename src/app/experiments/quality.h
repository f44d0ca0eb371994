#pragma once
// Quality of decoded pictures, summed over a film.
#include "app/experiments/trial.h"

namespace render2mpeg::app {

/// What decoded pictures come to.
struct Quality {
    double psnr_y = 0, ssim_y = 0;  ///< dB, +infinity where nothing differs; 1 likewise
    double psnr_hvs_m = 0;          ///< dB, likewise
};

/// Quality against light by every light point of pictures that are known against themselves as lit (`shown`), by how
/// much light adds on those few that both are known of (`there`, `decoded`): coding's error is that of all pictures, so
/// that neither the choice of the few nor the type and quantiser of one of them decide.
Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded);

/// The sample's, by its references where there are any; else against its pictures as lit. PSNR-HVS-M only of trials
/// that look for it (Trials::mask_all).
Quality quality_of(const Trial& trial, bool against_references);

}  // namespace render2mpeg::app
