#pragma once
// Cost and quality of each setting of a sweep for the whole film.
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/estimate/forecast.h"
#include "app/experiments/trial_command.h"
#include "app/job/render_job.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// All films with one effect less, and with less spent on accuracy, by the names of what is left out. Without choices:
/// the scene alone decides.
std::vector<Setting> left_out_of(const RenderJob& film);

struct EffectCost {
    std::string name, option;  ///< "kept light", "--cache off"; empty: without an option
    double share = 0;          ///< of the whole film's CPU time; below 0: the film would take more without it
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

/// Results of `cost`.
struct Sweep {
    std::vector<Tried> rows;           ///< fixed tolerances from loose to tight, coupled, efforts
    std::optional<PathTruth> truth;    ///< none: not known
    std::optional<Forecast> forecast;  ///< of the film as it was asked for
    double pixels = 0;                 ///< of its frames
    EffectCosts effects;
    std::string render;     ///< the command for the row to take; empty: none is known
    bool complete = false;  ///< false: interrupted

    /// The tightest fixed tolerance; null: none was tried.
    const Trial* best() const;
};

struct FilmCost {
    std::string name;
    Choices choices;
    const Trial* trial = nullptr;  ///< null: by truth
    double clock = 0;              ///< seconds on this machine, as busy as it was
    double cpu = 0;                ///< seconds of all threads
    double bytes = 0;              ///< of the film's pictures
    std::optional<double> added;   ///< dB of PSNR-HVS-M of what is added to the most exact row's error; none: nothing
    double psnr_loss = 0;          ///< dB of PSNR-Y below the most exact row; 0 where that is not known

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
nlohmann::json cost_page(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& costs);

/// Columns of `cost`, in 80 characters.
extern const TrialColumns cost_columns;
inline constexpr int cost_name_width = 14;

}  // namespace render2mpeg::app
