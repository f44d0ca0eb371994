#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/experiments/effect_costs.h"
#include "app/experiments/film_costs.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/loop/forecast.h"
#include "app/options/option_text.h"
#include "app/options/options.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Runs the command; rows are printed as they come.
class Cost {
  public:
    Cost(const CostOptions& options, const RenderJob& film, const Sample& sample, std::optional<Forecast> forecast)
        : options_(options),
          quantisers_(options.quantisers ? in_scale_of(film.coding.codec, quantisers_from(*options.quantisers))
                                         : std::vector<int>{film.coding.quantiser}),
          pairs_(!quantisers_.empty()),
          trials_(film, windows_of(film.frames, sample)) {
        sweep_.windows = trials_.windows();
        sweep_.forecast = std::move(forecast);
        if (options.kept_references) trials_.keep_references_in(ReferenceCache(*options.kept_references));
        print_memory_note(trials_.bytes_held(pairs_), options.render.quiet);
    }

    /// Returns whether nobody interrupted.
    bool light_references();
    bool try_efforts();
    bool try_fixed();
    bool try_coupled();
    /// The film without each of its effects.
    bool try_effects(const RenderJob& asked, int frames, double limit);
    void settle(const std::string& render) { sweep_.render = render; }
    void complete() { sweep_.complete = true; }

    const Sweep& sweep() const { return sweep_; }
    std::vector<FilmCost> film_rows() const { return film_costs(sweep_, film()); }
    const RenderJob& film() const { return trials_.film(); }

  private:
    bool is_quiet() const { return options_.render.quiet; }
    void log(const std::string& text) const {
        if (!is_quiet()) print(text);
    }
    std::optional<Trial> run(const ToleranceRequest& tolerance, int quantiser, const std::string& name,
                             LitWindows* keep) {
        return run_trial(trials_, tolerance, quantiser, name, is_quiet(), keep);
    }

    const CostOptions& options_;
    std::vector<int> quantisers_;  ///< to couple light to, ascending
    bool pairs_;                   ///< coupled light is asked for: light of a fixed 2 % is kept to be coded beside it
    Trials trials_;
    Sweep sweep_;
    LitWindows usual_;  ///< lit by a fixed 2 %
};

bool Cost::light_references() {
    if (!app::light_references(trials_, is_quiet())) return false;
    const renderer::Statistics& statistics = trials_.statistics();
    sweep_.direct_points = statistics.direct_points;
    sweep_.indirect_points = statistics.indirect_points;
    sweep_.references = trials_.references();
    sweep_.reference_seconds = trials_.reference_seconds();
    log(cost_heading(film(), sweep_));
    return true;
}

bool Cost::try_efforts() {
    const auto attempt = [&](const std::string& name, const RenderJob& job) {
        Progress progress(trials_.frames(), is_quiet() || !shows_steps(), "effort " + name, Counted::frames_of_step);
        const std::optional<Trial> trial = trials_.run_other(job, [&] {
            progress.advance();
            return !InterruptGuard::requested();
        });
        if (trial) sweep_.efforts.emplace_back(name, *trial);
        return trial.has_value();
    };
    if (!attempt("draft", draft_of(film()))) return false;
    for (const Effort& effort : efforts)
        if (std::string_view(effort.name) != "default" && !attempt(effort.name, at_effort(film(), effort)))
            return false;
    return true;
}

bool Cost::try_fixed() {
    const int quantiser = film().coding.quantiser;
    log(fixed_heading(quantiser));
    for (const float share : percents_from(options_.tolerances)) {
        const bool keep = share == 0.02f && pairs_;
        const auto trial =
            run({false, share, false, {}}, quantiser, "fixed " + tolerance_text(share), keep ? &usual_ : nullptr);
        if (!trial) return false;
        sweep_.fixed.push_back(*trial);
        log(fixed_row(*trial));
    }
    return true;
}

bool Cost::try_coupled() {
    if (!pairs_) return true;
    if (usual_.frames.empty() && !run({}, film().coding.quantiser, "fixed 2 %", &usual_)) return false;
    log(pair_heading());
    for (const int quantiser : quantisers_) {
        const auto coupled =
            run({false, 0, true, {}}, quantiser, fmt::format("coupled, quantiser {}", quantiser), nullptr);
        if (!coupled) return false;
        sweep_.pairs.push_back(
            {*coupled, told("coding", is_quiet(), [&] { return trials_.coded_again(usual_, quantiser); })});
        log(pair_rows(sweep_.pairs.back()));
    }
    return true;
}

bool Cost::try_effects(const RenderJob& asked, int frames, double limit) {
    sweep_.effects = effect_costs(asked, frames, limit, is_quiet(), [&](const EffectCost& cost, bool is_first) {
        log((is_first ? effects_heading() : "") + effect_row(cost));
    });
    if (sweep_.effects.left > 0 && !InterruptGuard::requested())
        log(fmt::format("\n{} effects were not left out: --within {} has no time for them\n", sweep_.effects.left,
                        options_.within));
    return !InterruptGuard::requested();
}

/// Sample of the film, and of its effects.
struct CostSample {
    Sample sweep;
    double scale = 1;       ///< of its pictures
    int effect_frames = 2;  ///< of the windows that effects are left out of
    std::optional<Forecast> forecast;
};

/// Light of a window's later frames over that of the film's own settings, by fixed tolerance.
/// chosen: as cornell's 16 to 2 % beside its coupled light at quantiser 4; references take some ten frames.
constexpr double usual_share = 0.065, of_reference = 10, of_efforts = 2.6;

/// Frames of the film's own settings that all settings light, for each frame of the sample.
double settings_of(const CostOptions& options) {
    double settings = 1 + of_efforts;
    for (const float share : percents_from(options.tolerances)) settings += usual_share / static_cast<double>(share);
    return settings;
}

/// The largest sample that there is time for; of smaller pictures where one frame takes too long.
void fit_sample(const CostOptions& options, const RenderJob& film, double first, double frame, double time,
                CostSample& chosen) {
    const double settings = settings_of(options);
    const auto takes = [&](const Sample& s) {
        return s.windows * (settings * (first + (s.frames - 1) * frame) + of_reference * frame);
    };
    for (const Sample& sample : {Sample{1, 2}, Sample{1, 3}, Sample{2, 3}})
        if (takes(sample) < time) chosen.sweep = sample;
    // chosen: 160 pixels show what tolerances do (96 to 320); CPU grows with the pixels, or slower.
    constexpr double least_side = 160;
    const double smallest = std::min(1.0, least_side / std::max(film.format.width, film.format.height));
    chosen.scale = std::clamp(std::sqrt(time / takes(chosen.sweep)), smallest, 1.0);
}

/// Forecast of the film, and a sample that --within has time for. None after an interruption.
std::optional<CostSample> first_answer(const CostOptions& options, RenderJob& film) {
    if (options.sample) {
        const Sample sample = sample_from(*options.sample);
        return CostSample{sample, 1, std::min(sample.frames, 3), {}};
    }
    const double within = time_in_seconds(options.within);
    // chosen: ten seconds are waited for.
    std::optional<Forecast> found = forecast(film, {}, std::min(10.0, 0.2 * within), options.render.quiet);
    if (!found) return {};
    if (!options.render.quiet) print(film_text(film) + "\n" + text_of(*found) + "\n");
    const double pace = core::divide_or(found->clock, found->cpu, 1.0), frame = found->later.seconds * pace,
                 first = found->first.seconds * pace;
    const auto effects = static_cast<double>(left_out_of(film).size()) + 1;
    CostSample chosen{{1, 1}, 1, 2, std::move(found)};
    fit_sample(options, film, first, frame, 0.6 * within, chosen);
    if (effects * (first + 2 * frame) < 0.3 * within) chosen.effect_frames = 3;
    return chosen;
}

}  // namespace

int cost(const CostOptions& options, const std::vector<std::string>& words) {
    const std::string command = line_of(words);
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    const bool quiet = options.render.quiet;
    const auto interrupted = [&] {
        if (!quiet) print_line("interrupted before the first row: nothing was found out");
        return InterruptGuard::status();
    };
    require_trial_consent(options);
    const double began = clock_seconds();
    RenderJob film = prepare_trials(options.render);
    if (InterruptGuard::requested()) return interrupted();
    check_trial_outputs(film, options);
    const std::optional<CostSample> sample = first_answer(options, film);
    if (!sample) return interrupted();

    Cost sweep(options, resized(film, sample->scale), sample->sweep, sample->forecast);
    const bool whole = sweep.light_references() && sweep.try_fixed() && sweep.try_coupled() && sweep.try_efforts();
    const Sweep& found = sweep.sweep();
    if (found.fixed.empty() && found.pairs.empty()) return interrupted();
    // An explicit sample has no time limit.
    const double limit = options.sample ? std::numeric_limits<double>::infinity()
                                        : std::max(began + time_in_seconds(options.within), clock_seconds() + 5);
    if (whole && sweep.try_effects(film, sample->effect_frames, limit)) sweep.complete();

    const std::vector<FilmCost> rows = sweep.film_rows();
    if (const auto taken = recommended(rows))
        sweep.settle(render_command(words, options.render.input, sweep.film().coding.codec,
                                    {{rows[*taken].option, rows[*taken].value}}));
    ErrorCollector errors;
    if (options.json) errors.attempt([&] { write_json(*options.json, cost_json(sweep.film(), found, rows, command)); });
    if (options.report) errors.attempt([&] { write_cost_report(*options.report, sweep.film(), found, rows, command); });
    if (!quiet)
        errors.attempt([&] {
            print(film_cost_table(rows));
            print_sentence(answer_of(rows, sweep.film()));
            if (!found.render.empty()) print("\n" + found.render + "\n");
        });
    if (!found.complete && !quiet) print_line("interrupted: this is a part of the table");
    errors.rethrow();
    return found.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
