#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/estimate/forecast.h"
#include "app/experiments/film_costs.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// From cheap to dear within each group.
std::vector<Setting> settings_of(const TrialOptions& options, const RenderJob& film) {
    std::vector<Setting> all;
    const auto add = [&](const std::string& before, const char* option, const std::string& value, RenderJob changed) {
        all.push_back({before + value, {{option, value}}, std::move(changed)});
    };
    for (const float share : options.tolerances)
        add("", "--tolerance", fmt::format("fixed={:.4g}%", 100 * share), with_tolerance(film, fixed_tolerance(share)));
    add("", "--tolerance", "coupled", film);
    add("effort ", "--effort", "draft", draft_of(film));
    for (const Effort& effort : efforts)
        if (std::string_view(effort.name) != "default")
            add("effort ", "--effort", effort.name, at_effort(film, effort, options.render));
    return all;
}

/// Sample of the film, and of its effects.
struct CostSample {
    SampleExtent sweep;
    double scale = 1;       ///< of its pictures
    int effect_frames = 2;  ///< of the windows that effects are left out of
    std::optional<Forecast> forecast;
};

/// The largest sample that there is time for; of smaller pictures where one frame takes too long.
void fit_sample(const TrialOptions& options, const RenderJob& film, double first, double frame, double time,
                CostSample& chosen) {
    // chosen: frames of the film's own settings that take as long: a fixed tolerance as cornell's 16 to 2 % beside its
    // coupled light at quantiser 4; efforts; and references with their truth.
    constexpr double of_tolerance = 0.065, of_efforts = 2.6, of_reference = 14;
    double settings = 1 + of_efforts;
    for (const float share : options.tolerances) settings += of_tolerance / static_cast<double>(share);
    const auto takes = [&](const SampleExtent& s) {
        return s.windows * (settings * (first + (s.frames - 1) * frame) + of_reference * frame);
    };
    for (const SampleExtent& sample : {SampleExtent{1, 2}, SampleExtent{1, 3}, SampleExtent{2, 3}})
        if (takes(sample) < time) chosen.sweep = sample;
    // chosen: 160 pixels show what tolerances do (96 to 320); CPU grows with the pixels, or slower.
    constexpr double least_side = 160;
    const double smallest = scale_for(film, least_side);
    chosen.scale = std::clamp(std::sqrt(time / takes(chosen.sweep)), smallest, 1.0);
}

/// Forecast of the film, and a sample that --within has time for. None after an interruption.
std::optional<CostSample> first_answer(const TrialOptions& options, RenderJob& film) {
    if (options.sample) {
        const SampleExtent sample = *options.sample;
        return CostSample{sample, 1, std::min(sample.frames, 3), {}};
    }
    const double within = options.within;
    // chosen: ten seconds are waited for.
    std::optional<Forecast> found = forecast(film, {}, std::min(10.0, 0.2 * within), options.render.quiet);
    if (!found) return {};
    if (!options.render.quiet) print(film_text(film) + "\n" + text_of(*found) + "\n");
    const double pace = core::divide_or(found->clock, found->cpu, 1.0), frame = found->later.seconds * pace,
                 first = found->first.seconds * pace;
    const auto effects = static_cast<double>(left_out_of(film).size()) + 1;
    CostSample chosen{{1, 1}, 1, 2, std::move(found)};
    fit_sample(options, film, first, frame, 0.6 * within, chosen);
    if (chosen.forecast->is_least) chosen.forecast.reset();
    if (effects * (first + 2 * frame) < 0.3 * within) chosen.effect_frames = 3;
    return chosen;
}

/// Runs the command; rows are printed as they come.
class Cost {
  public:
    Cost(const TrialOptions& options, const RenderJob& film, const CostSample& sample)
        : options_(options),
          asked_(film),
          sample_(sample),
          trials_(resized(film, sample.scale), middle_windows(film, sample.sweep.windows, sample.sweep.frames)) {
        trials_.ask_installed_metrics();
        sweep_.forecast = sample.forecast;
        sweep_.pixels = static_cast<double>(film.format.width) * film.format.height;
        check_memory(trials_.bytes_held(false));
    }

    /// Returns whether anything was found out.
    bool run(double began);
    void write(const std::vector<std::string>& words);
    bool is_complete() const { return sweep_.complete; }

  private:
    bool is_quiet() const { return options_.render.quiet; }
    void log(const std::string& text) const {
        if (!is_quiet()) print(text);
    }
    bool try_settings();
    /// The film without each of its effects.
    bool try_effects(double limit);

    const TrialOptions& options_;
    const RenderJob& asked_;
    const CostSample& sample_;
    Trials trials_;
    Sweep sweep_;
};

bool Cost::try_settings() {
    find_truth(trials_, is_quiet());
    sweep_.truth = trials_.truth();
    log(trial_heading(trials_) +
        "\nLight: CPU seconds per frame, rays and clusters per point; error of a pixel's\n"
        "light, %: 50 and 95 of 100 err by no more, over: beyond tolerance; as decoded\n" +
        heads_text(cost_columns, "setting", cost_name_width));
    for (const Setting& setting : settings_of(options_, trials_.film())) {
        const std::optional<Tried> row = run_trial(trials_, setting, is_quiet());
        if (!row) return false;
        sweep_.rows.push_back(*row);
        log(row_text(cost_columns, row->name, cost_name_width, row->trial));
    }
    return !InterruptGuard::requested();
}

bool Cost::try_effects(double limit) {
    sweep_.effects = effect_costs(
        asked_, sample_.effect_frames, limit, is_quiet(),
        [&](const EffectCost& cost, bool is_first) { log((is_first ? effects_heading() : "") + effect_row(cost)); });
    if (sweep_.effects.left > 0 && !InterruptGuard::requested())
        log(fmt::format("\n{} effects were not left out: --within {} has no time for them\n", sweep_.effects.left,
                        clock_text(options_.within)));
    return !InterruptGuard::requested();
}

bool Cost::run(double began) {
    const bool whole = light_references(trials_, is_quiet()) && try_settings();
    if (sweep_.rows.empty()) return false;
    // An explicit sample has no time limit.
    const double limit = options_.sample ? std::numeric_limits<double>::infinity()
                                         : std::max(began + options_.within, clock_seconds() + 5);
    sweep_.complete = whole && try_effects(limit);
    return true;
}

void Cost::write(const std::vector<std::string>& words) {
    const RenderJob& film = trials_.film();
    const std::vector<FilmCost> costs = film_costs(sweep_, film.frame_count());
    if (const auto taken = recommended(costs))
        sweep_.render = line_of(render_command(words, options_.render.input, film.coding.codec, costs[*taken].choices));
    const std::string answer = answer_of(costs, film.frame_count());
    if (!is_quiet()) {
        print(film_cost_table(costs));
        std::vector<NamedTrial> rows;
        for (const Tried& row : sweep_.rows) rows.emplace_back(row.name, &row.trial);
        print(installed_table(trials_, cost_name_width, rows));
        print_sentence(answer);
        if (!sweep_.render.empty()) print("\n" + sweep_.render + "\n");
        if (!sweep_.complete) print_line("interrupted: this is a part of the table");
    }
    write_results(options_, trials_, words, cost_json(sweep_, costs, film.frame_count()), [&] {
        return TrialPage{"cost", "what accuracy costs",
                         (sweep_.complete ? "" : "Interrupted: this is a part of it. ") + answer,
                         cost_page(film, sweep_, costs)};
    });
}

}  // namespace

int cost(const TrialOptions& options, const std::vector<std::string>& words) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    const double began = clock_seconds();
    RenderJob film = prepare_trials(options.render, options);
    std::optional<CostSample> sample;
    if (!InterruptGuard::requested()) sample = first_answer(options, film);
    if (!sample) return interrupted_before_rows(options.render.quiet);
    Cost sweep(options, film, *sample);
    if (!sweep.run(began)) return interrupted_before_rows(options.render.quiet);
    sweep.write(words);
    return sweep.is_complete() ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
