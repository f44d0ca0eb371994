#pragma once

#include <cstdint>
#include <vector>

#include "app/loop/pipeline.h"
#include "bench/coupled_stage.h"

namespace render2mpeg::bench {

/// One film's cost and what it came to, over all frames (cost, bytes, pumping) or the reference's (all else).
struct Outcome {
    double shade_seconds = 0;   ///< CPU, rough first looks included
    double gather_seconds = 0;  ///< the part of it after photons are traced and trees are planned, which k cannot save
    double preview_seconds = 0;
    double tolerate_seconds = 0;
    double rays = 0;            ///< shadow rays
    double cut = 0;             ///< clusters per point over light points
    double capped = 0;          ///< share of points
    double error_scale = 0;     ///< mean over frames
    double tolerance = 0;       ///< mean of tolerance over luminance, at pixels that gather light
    double tolerance_luma = 0;  ///< root mean square, in code values
    double over = 0;            ///< share of gathering pixels whose luminance is off by more than their tolerance
    double bytes = 0;
    double psnr_y = 0, psnr_c = 0, ssim = 0, hvs_m = 0;  ///< decoded against the reference not coded
    double light_mse = 0;                                ///< of luma before coding against the reference
    double flicker = 0;  ///< mean absolute difference along motion, less the reference's; code values
    double pumping = 0;  ///< the same difference's mean at I pictures less its mean at all others
};

/// Lit by `film.tolerance`, coded, decoded and measured.
Outcome made(const app::RenderJob& film, const Stage& stage);

/// Films lit by a fixed tolerance do not depend on how they are coded: lit once, coded as often as asked.
class LitFilm {
  public:
    LitFilm(const app::RenderJob& film, const Stage& stage);
    Outcome coded(int quantiser) const;

  private:
    app::RenderJob film_;
    const Stage& stage_;
    Outcome lit_;
    std::vector<core::Picture> pictures_;
};

}  // namespace render2mpeg::bench
