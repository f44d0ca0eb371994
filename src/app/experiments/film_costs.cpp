#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/files/file_io.h"
#include "app/report/frame_view.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// The longest side of the pictures. chosen: 320, in which every effect is seen, and ten pictures make no large page.
constexpr double longest_side = 320;

/// Times that are less than this share apart are not told apart. chosen: what CPU times of a few frames scatter by.
constexpr double least_share = 0.03;

/// By a renderer of its own, so that each film has its one-time work in its time. None after an interruption.
std::optional<LitWindows> light(const RenderJob& film, int frames, const std::string& name, bool quiet) {
    Trials trials(resized(film, scale_for(film, longest_side)), middle_windows(film, 1, frames), 0);
    LitWindows lit;
    if (!run_trial(trials, {name, {}, trials.film()}, quiet, &lit)) return {};
    return lit;
}

/// Of the last frames, in which light that is kept shows most.
EffectCost difference_of(const LitWindows& whole, const LitWindows& less) {
    EffectCost cost;
    cost.whole = whole.frames.rbegin()->second.picture;
    cost.without = less.frames.rbegin()->second.picture;
    const double masked = perceptual::masked_error(cost.without.y, cost.whole.y);
    if (masked > 0) cost.difference = perceptual::psnr(masked);
    perceptual::FilmQuality quality;
    quality.add(cost.without, cost.whole);
    cost.psnr_y = quality.psnr_y();
    cost.share = 1 - core::divide_or(less.light.cpu, whole.light.cpu, 1.0);
    return cost;
}

}  // namespace

std::vector<Setting> left_out_of(const RenderJob& film) {
    std::vector<Setting> all;
    for (const renderer::PlanRow& row : film.plan.rows())
        if (row.runs && *row.effect != '\0') all.push_back({row.effect, {}, without(film, row.pass)});
    const auto add = [&](const char* name, const Choices& choices, auto&& leave_out) {
        all.push_back({name, choices, film});
        leave_out(all.back().film);
    };
    renderer::Settings r = film.rendering;
    if (film.cache.keeps())
        add("kept light", {{"--cache", "off"}}, [](RenderJob& f) { f.rendering.cache = renderer::CacheUse::off; });
    if (film.tolerance.coupled) add("coupling", {{"--tolerance", "fixed=2%"}}, [](RenderJob& f) { f.tolerance = {}; });
    if (r.edge_samples > r.samples)
        add("finer edges", {{"--edge-samples", std::to_string(r.samples)}},
            [](RenderJob& f) { f.rendering.edge_samples = f.rendering.most_samples = 0; });
    return all;
}

EffectCosts effect_costs(const RenderJob& film, int frames, double limit, bool quiet,
                         const std::function<void(const EffectCost&, bool)>& row_done) {
    const std::vector<Setting> effects = left_out_of(film);
    EffectCosts costs;
    costs.left = static_cast<int>(effects.size());
    if (clock_seconds() > limit) return costs;
    const std::optional<LitWindows> whole = light(film, frames, "all effects", quiet);
    if (!whole) return costs;
    const core::Picture& picture = whole->frames.begin()->second.picture;
    costs.size = {picture.width(), picture.height()};
    costs.frames = whole->light.frames;
    for (const Setting& effect : effects) {
        if (clock_seconds() > limit) break;
        const std::optional<LitWindows> less = light(effect.film, frames, "without " + effect.name, quiet);
        if (!less) break;
        EffectCost cost = difference_of(*whole, *less);
        cost.name = effect.name;
        for (const auto& [option, value] : effect.choices) (cost.option = option).append(" ").append(value);
        row_done(cost, costs.rows.empty());
        costs.rows.push_back(std::move(cost));
        --costs.left;
    }
    return costs;
}

std::string share_text(double share) {
    if (std::abs(share) < least_share) return fmt::format("under {:.0f} %", 100 * least_share);
    return fmt::format("{}{:.0f} %", share < 0 ? "saves " : "", 100 * std::abs(share));
}

std::string effects_heading() {
    return fmt::format("\nWhat each effect takes, and what one sees where it is left out\n{:<32} {:>10}  {}\n",
                       "effect", "time", "without it");
}

std::string effect_row(const EffectCost& cost) {
    const std::string name = cost.name + (cost.option.empty() ? "" : " (" + cost.option + ")");
    return fmt::format("{:<32} {:>10}  {}{}\n", name, share_text(cost.share), words_for(cost.difference),
                       cost.difference ? fmt::format(" ({:.0f} dB)", *cost.difference) : "");
}

namespace {

/// [Ponomarenko2007]: below some 42 dB differences are seen. chosen: 4 and 8 dB more for errors that are not even.
constexpr double invisible = 50, hardly = 46, slight = 42;

using nlohmann::json;

bool is_effort(const Choices& choices) {
    return choices.front().first == "--effort";
}
bool is_coupled(const Tried& row) {
    return row.choices.front().second == "coupled";
}

struct Base {
    double cpu = 0, bytes = 0;  ///< of the film, for one of the sample's frame
    double pace = 0;            ///< seconds on the clock for one of CPU
};

/// The film as asked for is coupled: its forecast is that row's.
Base base_of(const Sweep& sweep, double frames) {
    const auto asked = std::ranges::find_if(sweep.rows, is_coupled);
    if (!sweep.forecast || asked == sweep.rows.end()) {
        // Mean pace of all rows, since the machine's load changes.
        double clock = 0, cpu = 0;
        for (const Tried& row : sweep.rows) clock += row.trial.clock, cpu += row.trial.cpu;
        return {frames, frames, core::divide_or(clock, cpu, 1.0)};
    }
    const Forecast& f = *sweep.forecast;
    return {core::divide_or(f.cpu, asked->trial.cpu, frames), core::divide_or(f.bytes, asked->trial.film_bytes, frames),
            core::divide_or(f.clock, f.cpu, 1.0)};
}

/// One frame by each row of the film's table, null where there is none, beside exact light; null without references.
json accuracies_json(const std::vector<FilmCost>& costs, const perceptual::PictureColors& colors) {
    json sources = json::array(), shown = nullptr;
    for (const FilmCost& cost : costs) {
        sources.push_back(nullptr);
        if (cost.trial == nullptr || !cost.trial->sample_frame) continue;
        const SampleFrame& frame = *cost.trial->sample_frame;
        sources.back() = source_of(cost.name, frame.lit, colors);
        if (shown.is_null())
            shown = {{"frame", frame.frame},
                     {"width", shown_width(frame.lit.width())},
                     {"exact", source_of("exact", frame.reference, colors)}};
    }
    if (!shown.is_null()) shown["sources"] = sources;
    return shown;
}

json film_json(const std::vector<FilmCost>& costs) {
    json film = json::array();
    const std::optional<std::size_t> taken = recommended(costs);
    for (std::size_t i = 0; i < costs.size(); ++i)
        film.push_back({{"option", costs[i].choices.front().first},
                        {"value", costs[i].choices.front().second},
                        {"clock", costs[i].clock},
                        {"cpu", costs[i].cpu},
                        {"bytes", costs[i].bytes},
                        {"difference", costs[i].difference()},
                        {"added_psnr_hvs_m", finite_or_null(costs[i].added)},
                        {"psnr_y_loss", costs[i].psnr_loss},
                        {"recommended", taken == i}});
    return film;
}

json effects_json(const EffectCosts& effects) {
    json rows = json::array();
    for (const EffectCost& e : effects.rows)
        rows.push_back({{"effect", e.name},
                        {"option", text_or_null(e.option)},
                        {"time_share", e.share},
                        {"difference", words_for(e.difference)},
                        {"psnr_hvs_m", finite_or_null(e.difference)},
                        {"psnr_y", finite_or_null(e.psnr_y)}});
    return {{"width", effects.size.width}, {"height", effects.size.height}, {"frames", effects.frames}, {"rows", rows}};
}

}  // namespace

const TrialColumns cost_columns{"light_seconds",  "rays_per_point", "cut",    "error_p50", "error_p95",
                                "over_tolerance", "psnr_y",         "ssim_y", "bytes"};

const Trial* Sweep::best() const {
    const Trial* best = nullptr;
    for (const Tried& row : rows)
        if (!is_effort(row.choices) && !is_coupled(row)) best = &row.trial;
    return best;
}

std::string FilmCost::difference() const {
    if (trial == nullptr) return fmt::format("exact, by paths to {} %", PathTruth::percent);
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
    for (const auto& [name, choices, trial] : sweep.rows) {
        const double added = trial.masked_error - best.masked_error;
        const double loss = best.film_quality().psnr_y - trial.film_quality().psnr_y;
        costs.push_back({name, choices, &trial, base.pace * base.cpu * trial.cpu, base.cpu * trial.cpu,
                         base.bytes * trial.film_bytes,
                         added > 0 ? std::optional(perceptual::psnr(added)) : std::nullopt,
                         std::isfinite(loss) ? std::max(0.0, loss) : 0.0});
    }
    if (sweep.truth) {
        const double cpu = frames * sweep.pixels * sweep.truth->share * sweep.truth->seconds +
                           base.cpu * std::max(0.0, best.cpu - best.seconds);
        costs.push_back(
            {"truth", {{"--tolerance", "truth"}}, nullptr, base.pace * cpu, cpu, base.bytes * best.film_bytes, {}, 0});
    }
    std::ranges::stable_sort(costs, {}, &FilmCost::cpu);
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
        here.name, frames, time_text(here.clock, here.cpu), size_text(here.bytes), words_for(here.added));
}

std::string film_cost_table(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::string text =
        fmt::format("\nThe whole film on this machine's {} threads\n{:<14} {:>8} {:>8} {:>9}  {}\n",
                    parallel::thread_count(), "setting", "clock", "CPU, s", "size", "difference from exact light");
    for (std::size_t i = 0; i < costs.size(); ++i)
        text +=
            fmt::format("{:<14} {:>8} {:>8.0f} {:>9}  {}{}\n", costs[i].name, clock_text(costs[i].clock), costs[i].cpu,
                        size_text(costs[i].bytes), costs[i].difference(), taken == i ? " <- take" : "");
    return text;
}

json cost_json(const Sweep& sweep, const std::vector<FilmCost>& costs, std::int64_t frames) {
    json rows = json::array();
    for (const Tried& row : sweep.rows) {
        const char* const group = is_effort(row.choices) ? "effort"
                                  : is_coupled(row)      ? "coupled to coding"
                                                         : "fixed tolerance";
        rows.push_back(figures_json(row.trial));
        rows.back().update({{"group", group}, {"name", row.choices.front().second}});
    }
    return {{"rows", rows},
            {"film", film_json(costs)},
            {"render", text_or_null(sweep.render)},
            {"effects", effects_json(sweep.effects)},
            {"summary", answer_of(costs, frames)},
            {"complete", sweep.complete}};
}

json cost_page(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& costs) {
    const perceptual::PictureColors colors = film.colors();
    const std::optional<std::size_t> taken = recommended(costs);
    const bool is_shown = taken && costs[*taken].trial != nullptr;
    const Tried& first = sweep.rows.front();
    json without = json::array(), wholes = json::object();
    for (const EffectCost& cost : sweep.effects.rows) {
        without.push_back({{"source", source_of("without " + cost.name, cost.without, colors)},
                           {"width", shown_width(cost.without.width())},
                           {"frame", cost.whole.number}});
        wholes.emplace(std::to_string(cost.whole.number), source_of("all effects", cost.whole, colors));
    }
    return {{"threads", parallel::thread_count()},
            {"truth", truth_text(sweep.truth)},
            {"accuracies", accuracies_json(costs, colors)},
            {"without", without},
            {"wholes", wholes},
            {"sample", is_shown ? sample_frame_figures(costs[*taken].name, *costs[*taken].trial, film)
                                : sample_frame_figures(first.name, first.trial, film)}};
}

}  // namespace render2mpeg::app
