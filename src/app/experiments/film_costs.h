#pragma once
// Cost and quality of each setting of a sweep for the whole film.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/trial.h"
#include "app/loop/forecast.h"
#include "app/report/answer.h"

namespace render2mpeg::app {

struct CoupledPair {
    Trial coupled, fixed;

    /// CPU time of coupled light over fixed; none where either is 0.
    std::optional<double> time_ratio() const;
    /// PSNR-Y lost by coupling, dB; none where either is infinite.
    std::optional<double> psnr_loss() const;
    double ssim_loss() const { return fixed.decoded.ssim_y() - coupled.decoded.ssim_y(); }
};

/// Results of `cost`.
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
/// Three digits at most.
std::string short_figure(double value);

struct FilmCost {
    std::string option, value;    ///< of `render`: "--tolerance", "fixed=2%"
    double clock = 0;             ///< seconds on this machine, as busy as it was
    double cpu = 0;               ///< seconds of all threads
    double bytes = 0;             ///< of the film's pictures
    std::optional<double> added;  ///< dB of PSNR-HVS-M of what is added to the most exact row's error; none: nothing
    double psnr_loss = 0;         ///< dB of PSNR-Y below the most exact row; 0 where that is not known

    std::string name() const { return option == "--effort" ? "effort " + value : value; }
};

/// Visibility of light's error by its PSNR-HVS-M: visible below some 42 dB [Ponomarenko2007]. chosen: two steps of 4 dB
/// above that, 2.5 times the error each, since light errs in blotches.
std::string words_for(const std::optional<double>& added);
Grade grade_of(const std::optional<double>& added);

/// All rows, from the cheapest. Times and sizes are in proportion to the forecast's, where there is one.
std::vector<FilmCost> film_costs(const Sweep& sweep, const RenderJob& film);

std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs);

/// The answer in one sentence; empty without rows.
std::string answer_of(const std::vector<FilmCost>& costs, const RenderJob& film);

std::string film_cost_table(const std::vector<FilmCost>& costs);
std::vector<AnswerRow> answer_rows(const std::vector<FilmCost>& costs);

/// Lines of at most 80 columns, each with its end.
std::string cost_heading(const RenderJob& film, const Sweep& sweep);
std::string fixed_heading(int quantiser);
std::string fixed_row(const Trial& trial);
std::string pair_heading();
std::string pair_rows(const CoupledPair& pair);

/// All results (docs/choosing.md).
nlohmann::json cost_json(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& rows,
                         const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_cost_report(const std::filesystem::path& html, const RenderJob& film, const Sweep& sweep,
                       const std::vector<FilmCost>& rows, const std::string& command);

}  // namespace render2mpeg::app
