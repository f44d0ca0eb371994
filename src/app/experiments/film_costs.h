#pragma once
// Cost and quality of each setting of a sweep for the whole film.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/trial_table.h"
#include "app/loop/forecast.h"

namespace render2mpeg::app {

struct TrialRow {
    std::string group;  ///< rows of one kind
    std::string name;   ///< within it
    Trial trial;
};

/// Results of `cost`.
struct Sweep {
    std::vector<TrialRow> rows;        ///< fixed tolerances from loose to tight, coupled, efforts
    std::optional<PathTruth> truth;    ///< none: not known
    std::optional<Forecast> forecast;  ///< of the film as it was asked for
    double pixels = 0;                 ///< of its frames
    EffectCosts effects;
    std::string render;     ///< the command for the row to take; empty: none is known
    bool complete = false;  ///< false: interrupted

    /// Groups of rows.
    static constexpr const char *fixed = "fixed tolerance", *coupled = "coupled to coding", *effort = "effort";
    /// The tightest fixed tolerance; null: none was tried.
    const Trial* best() const;
};

struct FilmCost {
    std::string option, value;    ///< of `render`: "--tolerance", "fixed=2%"
    double clock = 0;             ///< seconds on this machine, as busy as it was
    double cpu = 0;               ///< seconds of all threads
    double bytes = 0;             ///< of the film's pictures
    std::optional<double> added;  ///< dB of PSNR-HVS-M of what is added to the most exact row's error; none: nothing
    double psnr_loss = 0;         ///< dB of PSNR-Y below the most exact row; 0 where that is not known

    std::string name() const { return option == "--effort" ? "effort " + value : value; }
    /// "slight in flat areas (-0.62 dB)"
    std::string difference() const;
};

/// Visibility of light's error by its PSNR-HVS-M: visible below some 42 dB [Ponomarenko2007]. chosen: two steps of 4 dB
/// above that, 2.5 times the error each, since light errs in blotches.
std::string words_for(const std::optional<double>& added);

/// All rows, from the cheapest. Times and sizes are in proportion to the forecast's, where there is one.
std::vector<FilmCost> film_costs(const Sweep& sweep, std::int64_t frames);

std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs);

/// The answer in one sentence; empty without rows.
std::string answer_of(const std::vector<FilmCost>& costs, std::int64_t frames);

std::string film_cost_table(const std::vector<FilmCost>& costs);

/// All results (docs/json.md), and what a page shows besides.
nlohmann::json cost_json(const Sweep& sweep, const std::vector<FilmCost>& costs, std::int64_t frames);
nlohmann::json cost_page(const RenderJob& film, const Sweep& sweep);

/// Columns of `cost`, in 80 characters.
extern const TrialColumns cost_columns;
inline constexpr int cost_name_width = 14;

}  // namespace render2mpeg::app
