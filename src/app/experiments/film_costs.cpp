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

json cost_page(const RenderJob& film, const Sweep& sweep) {
    const perceptual::ColorMatrix matrix = perceptual::matrix_for(film.format.height);
    const TrialRow& loosest = sweep.rows.front();
    json pictures = json::array(), without = json::array(), wholes = json::object();
    if (const auto& own = loosest.trial.sample_frame)
        pictures.push_back(
            pair_of(fmt::format("Frame {}, before coding: the loosest light beside the most exact", own->frame),
                    {loosest.name, own->lit}, {"exact", own->reference}, matrix, true));
    for (const EffectCost& cost : sweep.effects.rows) {
        without.push_back({{"source", source_of("without " + cost.name, cost.without, matrix)},
                           {"width", shown_width(cost.without.width())},
                           {"frame", cost.whole.number}});
        wholes.emplace(std::to_string(cost.whole.number), source_of("all effects", cost.whole, matrix));
    }
    return {{"threads", parallel::thread_count()},
            {"truth", truth_text(sweep.truth)},
            {"pictures", pictures},
            {"without", without},
            {"wholes", wholes},
            {"sample", sample_frame_figures(loosest.name, loosest.trial, film)}};
}

}  // namespace render2mpeg::app
