#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// [Ponomarenko2007]: below some 42 dB differences are seen. chosen: 4 and 8 dB more for errors that are not even.
constexpr double invisible = 50, hardly = 46, slight = 42;

constexpr const char* by_truth = "truth";

using nlohmann::json;

struct Base {
    double cpu = 0, bytes = 0;  ///< of the film, for one of the sample's frame
    double pace = 0;            ///< seconds on the clock for one of CPU
};

/// The film as asked for is coupled: its forecast is that row's.
Base base_of(const Sweep& sweep, double frames) {
    const auto asked = std::find_if(sweep.rows.begin(), sweep.rows.end(),
                                    [](const TrialRow& row) { return row.group == Sweep::coupled; });
    if (!sweep.forecast || asked == sweep.rows.end()) {
        // Mean pace of all rows, since the machine's load changes.
        double clock = 0, cpu = 0;
        for (const TrialRow& row : sweep.rows) clock += row.trial.clock, cpu += row.trial.cpu;
        return {frames, frames, core::divide_or(clock, cpu, 1.0)};
    }
    const Forecast& f = *sweep.forecast;
    return {core::divide_or(f.cpu, asked->trial.cpu, frames), core::divide_or(f.bytes, asked->trial.film_bytes, frames),
            core::divide_or(f.clock, f.cpu, 1.0)};
}

json film_json(const std::vector<FilmCost>& costs) {
    json film = json::array();
    const std::optional<std::size_t> taken = recommended(costs);
    for (std::size_t i = 0; i < costs.size(); ++i)
        film.push_back({{"option", costs[i].option},
                        {"value", costs[i].value},
                        {"clock", costs[i].clock},
                        {"cpu", costs[i].cpu},
                        {"bytes", costs[i].bytes},
                        {"difference", costs[i].difference()},
                        {"added_psnr_hvs_m", costs[i].added ? finite_or_null(*costs[i].added) : json(nullptr)},
                        {"psnr_y_loss", costs[i].psnr_loss},
                        {"recommended", taken == i}});
    return film;
}

json effects_json(const EffectCosts& effects) {
    json rows = json::array();
    for (const EffectCost& e : effects.rows)
        rows.push_back({{"effect", e.name},
                        {"option", e.option.empty() ? json(nullptr) : json(e.option)},
                        {"time_share", e.share},
                        {"difference", words_for(e.difference)},
                        {"psnr_hvs_m", e.difference ? finite_or_null(*e.difference) : json(nullptr)},
                        {"psnr_y", finite_or_null(e.psnr_y)}});
    return {{"width", effects.size.width}, {"height", effects.size.height}, {"frames", effects.frames}, {"rows", rows}};
}

std::vector<AnswerRow> answer_rows(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::vector<AnswerRow> rows;
    double longest = 0;
    for (const FilmCost& c : costs)
        if (c.value != by_truth) longest = std::max(longest, c.cpu);
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const FilmCost& c = costs[i];
        rows.push_back({c.name(), std::min(1.0, core::divide_or(c.cpu, longest, 1.0)), time_text(c.clock, c.cpu),
                        c.difference(), grade_of(c.added), "", size_text(c.bytes), taken == i});
    }
    return rows;
}

std::string first_screen(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& costs) {
    const TrialRow& loosest = sweep.rows.front();
    const std::string note = fmt::format(
        "Times are of this machine's {} threads, as busy as it was. From {} sample frame{} of {}x{}, quantiser {}. "
        "Words: what light adds to the error that one sees (PSNR-HVS-M of 50, 46, 42 dB). dB: PSNR-Y after coding, "
        "below the most exact tolerance. {}",
        parallel::thread_count(), loosest.trial.frames, loosest.trial.frames == 1 ? "" : "s", film.format.width,
        film.format.height, film.coding.quantiser, truth_text(sweep.truth));
    std::string figure;
    if (const auto& own = loosest.trial.sample_frame)
        figure = difference_figure(
            fmt::format("Frame {}, before coding: the loosest light beside the most exact", own->frame),
            {loosest.name, own->lit}, {"exact", own->reference}, perceptual::matrix_for(film.format.height));
    return answer_screen(
        answer_table({"accuracy of light", "time, whole film", "difference", "film"}, answer_rows(costs), note), figure,
        sweep.render);
}

}  // namespace

const TrialColumns cost_columns{&columns::light, &columns::rays,  &columns::cut,    &columns::median, &columns::p95,
                                &columns::over,  &columns::twice, &columns::psnr_y, &columns::ssim_y, &columns::bytes};

const Trial* Sweep::best() const {
    const Trial* best = nullptr;
    for (const TrialRow& row : rows)
        if (row.group == fixed) best = &row.trial;
    return best;
}

std::string FilmCost::difference() const {
    if (value == by_truth) return fmt::format("exact, by paths to {} %", PathTruth::percent);
    return words_for(added) + (psnr_loss < 0.005 ? "" : fmt::format(" (-{:.2f} dB)", psnr_loss));
}

std::string words_for(const std::optional<double>& added) {
    if (!added || *added >= invisible) return "none you can see";
    if (*added >= hardly) return "hardly any";
    return *added >= slight ? "slight in flat areas" : "visible";
}

Grade grade_of(const std::optional<double>& added) {
    if (!added || *added >= hardly) return Grade::good;
    return *added >= slight ? Grade::fair : Grade::poor;
}

std::vector<FilmCost> film_costs(const Sweep& sweep, std::int64_t frame_count) {
    std::vector<FilmCost> costs;
    if (sweep.best() == nullptr) return costs;
    const Trial& best = *sweep.best();
    const auto frames = static_cast<double>(frame_count);
    const Base base = base_of(sweep, frames);
    for (const TrialRow& row : sweep.rows) {
        const Trial& trial = row.trial;
        const double added = trial.masked_error - best.masked_error;
        const double loss = best.film_quality().psnr_y - trial.film_quality().psnr_y;
        costs.push_back({row.group == Sweep::effort ? "--effort" : "--tolerance", row.name,
                         base.pace * base.cpu * trial.cpu, base.cpu * trial.cpu, base.bytes * trial.film_bytes,
                         added > 0 ? std::optional(perceptual::psnr(added)) : std::nullopt,
                         std::isfinite(loss) ? std::max(0.0, loss) : 0.0});
    }
    if (sweep.truth) {
        const double cpu = frames * sweep.pixels * sweep.truth->share * sweep.truth->seconds +
                           base.cpu * std::max(0.0, best.cpu - best.seconds);
        costs.push_back({"--tolerance", by_truth, base.pace * cpu, cpu, base.bytes * best.film_bytes, {}, 0});
    }
    std::stable_sort(costs.begin(), costs.end(), [](const FilmCost& a, const FilmCost& b) { return a.cpu < b.cpu; });
    return costs;
}

std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs) {
    std::vector<Offer> offers;
    for (const FilmCost& cost : costs) offers.push_back({cost.cpu, !cost.added || *cost.added >= invisible});
    return cheapest_alike(offers);
}

std::string answer_of(const std::vector<FilmCost>& costs, std::int64_t frames) {
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return {};
    const FilmCost& here = costs[*taken];
    return fmt::format(
        "Take {}: your film of {} frames takes about {} and has about {}; the difference from exact light: {}.",
        here.name(), frames, time_text(here.clock, here.cpu), size_text(here.bytes), words_for(here.added));
}

std::string film_cost_table(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::string text =
        fmt::format("\nThe whole film on this machine's {} threads\n{:<14} {:>8} {:>8} {:>9}  {}\n",
                    parallel::thread_count(), "setting", "clock", "CPU, s", "size", "difference from exact light");
    for (std::size_t i = 0; i < costs.size(); ++i)
        text +=
            fmt::format("{:<14} {:>8} {:>8.0f} {:>9}  {}{}\n", costs[i].name(), clock_text(costs[i].clock),
                        costs[i].cpu, size_text(costs[i].bytes), costs[i].difference(), taken == i ? " <- take" : "");
    return text;
}

json cost_json(const Sweep& sweep, const std::vector<FilmCost>& costs, std::int64_t frames) {
    json rows = json::array();
    for (const TrialRow& row : sweep.rows) {
        rows.push_back(figures_json(row.trial));
        rows.back().update({{"group", row.group}, {"name", row.name}});
    }
    return {{"rows", rows},
            {"film", film_json(costs)},
            {"render", sweep.render.empty() ? json(nullptr) : json(sweep.render)},
            {"effects", effects_json(sweep.effects)},
            {"summary", answer_of(costs, frames)},
            {"complete", sweep.complete}};
}

std::string cost_page(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& costs) {
    const std::string quality =
                          plot_of("Quality of the decoded film over time", columns::light, columns::psnr_y, sweep.rows),
                      error = plot_of("Error of a pixel's light over time: 95 of 100 err by no more than",
                                      columns::light, columns::p95, sweep.rows);
    return first_screen(film, sweep, costs) +
           effects_section(sweep.effects, perceptual::matrix_for(film.format.height)) +
           folded(
               "All curves and figures",
               quality + error + sample_frame_figures(sweep.rows.front().name, sweep.rows.front().trial, film) +
                   html_of("What was tried", cost_columns, sweep.rows) +
                   "<p class=\"soft\">Light: CPU seconds of all threads per frame. Rays: shadow rays and gather rays "
                   "per gather point; cut: clusters of lights per point. 50 and 95 %: percentiles of the error of a "
                   "pixel's luminance against reference light, in %. Over: % of the pixels that err by more than "
                   "their tolerance; twice: by more than twice of it. PSNR-Y and SSIM: decoded pictures against "
                   "what is not coded, PSNR-Y the truth, SSIM reference light. Size per frame.</p>\n");
}

}  // namespace render2mpeg::app
