#pragma once
// Cost of each effect of a film, and pictures without it.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// A film without one effect.
struct LeftOut {
    std::string name;    ///< of what is left out: "bounced light"
    std::string option;  ///< that leaves it out, "--cache off"; empty: the scene alone decides
    RenderJob film;
};

/// All films with one effect less, and with less spent on accuracy.
std::vector<LeftOut> left_out_of(const RenderJob& film);

struct EffectCost {
    std::string name, option;
    double share = 0;  ///< of the whole film's CPU time; below 0: the film would take more without it
    /// PSNR-HVS-M of the lit pictures with and without it, dB; none: no visible difference.
    std::optional<double> difference;
    double psnr_y = 0;      ///< likewise; infinity where they are the same
    core::Picture without;  ///< the frame that differs most
    core::Picture whole;    ///< the same with all
};

struct EffectCosts {
    Size size;       ///< of the pictures that were lit
    int frames = 0;  ///< of each
    std::vector<EffectCost> rows;
    int left = 0;  ///< effects that there was no time for, or that an interruption left
};

/// Lights `frames` small frames from the middle of the film, and again without each effect. Begins none after `limit`
/// (clock_seconds()).
EffectCosts effect_costs(const RenderJob& film, int frames, double limit, bool quiet,
                         const std::function<void(const EffectCost&, bool is_first)>& row_done);

/// "41 %", "saves 12 %", "under 3 %"
std::string share_text(double share);

std::string effects_heading();
std::string effect_row(const EffectCost& cost);

}  // namespace render2mpeg::app
