#pragma once
// The rows of `cost`: one sample at several tolerances and quantisers.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/trial.h"
#include "app/loop/forecast.h"

namespace render2mpeg::app {

/// Light coupled to a quantiser, and light by a fixed 2 % coded with it.
struct CoupledPair {
    Trial coupled, fixed;

    /// CPU time of coupled light over that of fixed; none where either took none.
    std::optional<double> time_ratio() const;
    /// PSNR-Y that coupling loses, dB; none where either is infinite.
    std::optional<double> psnr_loss() const;
    double ssim_loss() const { return fixed.decoded.ssim_y() - coupled.decoded.ssim_y(); }
};

/// All that `cost` finds out.
struct Sweep {
    std::vector<Chunk> windows;
    int references = 0;
    double reference_seconds = 0;  ///< CPU for light per frame
    std::size_t direct_points = 0, indirect_points = 0;
    std::vector<Trial> fixed;  ///< from loose to tight
    std::vector<CoupledPair> pairs;
    std::vector<std::pair<std::string, Trial>> efforts;  ///< by name (app/options/effort.h)
    std::optional<Forecast> forecast;                    ///< of the film as it was asked for
    EffectCosts effects;
    std::string render;     ///< the command for the row to take; empty: none is known
    bool complete = false;  ///< false: interrupted
};

/// "0.25 %"
std::string tolerance_text(float share);
/// With three digits at most, as columns have room for.
std::string short_figure(double value);

}  // namespace render2mpeg::app
