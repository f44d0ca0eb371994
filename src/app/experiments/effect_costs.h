#pragma once
// What each effect of a film takes, and what pictures are without it.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "core/picture.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// A film without one thing that it is made with.
struct LeftOut {
    std::string name;    ///< of what is left out: "bounced light"
    std::string option;  ///< that leaves it out, "--cache off"; empty: the scene alone decides
    RenderJob film;
};

/// All that can be left out: each effect that the plan runs, and what the film spends on accuracy or saves of it.
std::vector<LeftOut> left_out_of(const RenderJob& film);

/// What it takes and gives.
struct EffectCost {
    std::string name, option;
    double share = 0;  ///< of the whole film's CPU time; below 0: the film would take more without it
    /// dB of PSNR-HVS-M between the lit pictures with and without it; none where that sees no difference.
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

/// Lights so many small frames from the middle of the film, and again without each effect. `row_done` is called with
/// each row, and whether it is the first. After `limit` (clock_seconds()) no other one is begun.
EffectCosts effect_costs(const RenderJob& film, int frames, double limit, bool quiet,
                         const std::function<void(const EffectCost&, bool is_first)>& row_done);

/// "41 %", "saves 12 %", "under 3 %"
std::string share_text(double share);

/// The rows as lines of a terminal.
std::string effects_heading();
std::string effect_row(const EffectCost& cost);

/// The table with a small picture of each, and a large one in which they can be seen beside the whole. Empty where
/// there are no rows.
std::string effects_section(const EffectCosts& effects, perceptual::ColorMatrix matrix);

}  // namespace render2mpeg::app
