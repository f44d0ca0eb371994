#pragma once
// What each setting of a sweep costs and buys for the whole film.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/trial.h"
#include "app/loop/forecast.h"
#include "app/report/answer.h"

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

/// One setting for the whole film.
struct FilmCost {
    std::string option, value;    ///< of `render`: "--tolerance", "fixed=2%"
    double clock = 0;             ///< seconds on this machine, as busy as it was
    double cpu = 0;               ///< seconds of all threads
    double bytes = 0;             ///< of the film's pictures
    std::optional<double> added;  ///< dB of PSNR-HVS-M of what is added to the most exact row's error; none: nothing
    double psnr_loss = 0;         ///< dB of PSNR-Y below the most exact row; 0 where that is not known

    std::string name() const { return option == "--effort" ? "effort " + value : value; }
};

/// How an error that light adds looks, by its PSNR-HVS-M (perceptual/hvs.h): below some 42 dB it is seen
/// [Ponomarenko2007]. chosen: two steps of 4 dB above that, 2.5 times the error each, since light errs in blotches.
std::string words_for(const std::optional<double>& added);
Grade grade_of(const std::optional<double>& added);

/// All rows, from the cheapest: fixed tolerances, coupled to the film's own quantiser where that was tried, efforts,
/// and every light point. The film as it was asked for has the time and the size of its forecast, where there is one,
/// and other rows have them in proportion.
std::vector<FilmCost> film_costs(const Sweep& sweep, const RenderJob& film);

/// The row to take (cheapest_alike).
std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs);

/// The answer in one sentence; empty where there is no row.
std::string answer_of(const std::vector<FilmCost>& costs, const RenderJob& film);

/// The rows as lines of a terminal.
std::string film_cost_table(const std::vector<FilmCost>& costs);
std::vector<AnswerRow> answer_rows(const std::vector<FilmCost>& costs);

/// Lines of at most 80 columns, each with its end.
std::string cost_heading(const RenderJob& film, const Sweep& sweep);
std::string fixed_heading(int quantiser);
std::string fixed_row(const Trial& trial);
std::string pair_heading();
/// Two rows: coupled, and fixed beside it.
std::string pair_rows(const CoupledPair& pair);

}  // namespace render2mpeg::app
