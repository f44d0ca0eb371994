#pragma once
// What each setting of a sweep costs and buys for the whole film.
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/sweep.h"
#include "app/report/answer.h"

namespace render2mpeg::app {

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

}  // namespace render2mpeg::app
