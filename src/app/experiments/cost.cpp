#include "app/experiments/cost.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/experiments/cost_report.h"
#include "app/experiments/cost_table.h"
#include "app/experiments/trial_command.h"
#include "app/files/text_file.h"
#include "app/options/option_text.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// One command in the making: rows are told as they come.
class Cost {
  public:
    Cost(const CostOptions& options, const RenderJob& film)
        : options_(options),
          pairs_(!quantisers_from(options.quantisers).empty()),
          trials_(film, windows_of(film.frames, sample_from(options.sample))) {
        sweep_.windows = trials_.windows();
        if (options.kept_references) trials_.keep_references_in(ReferenceCache(*options.kept_references));
        print_memory_note(trials_.bytes_held(pairs_), options.render.quiet);
    }

    /// Returns whether nobody interrupted.
    bool light_references();
    bool try_fixed();
    bool try_coupled();
    void complete() { sweep_.complete = true; }

    const Sweep& sweep() const { return sweep_; }
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
    bool pairs_;  ///< coupled light is asked for: light of a fixed 2 % is kept to be coded beside it
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
    for (const int quantiser : quantisers_from(options_.quantisers)) {
        const auto coupled =
            run({false, 0, true, {}}, quantiser, fmt::format("coupled, quantiser {}", quantiser), nullptr);
        if (!coupled) return false;
        sweep_.pairs.push_back({*coupled, trials_.coded_again(usual_, quantiser)});
        log(pair_rows(sweep_.pairs.back()));
    }
    return true;
}

}  // namespace

int cost(const CostOptions& options, const std::string& command) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    const bool quiet = options.render.quiet;
    const auto interrupted = [&] {
        if (!quiet) print_line("interrupted before the first row: nothing was found out");
        return InterruptGuard::status();
    };
    const RenderJob film = prepare_trials(options.render);
    if (InterruptGuard::requested()) return interrupted();
    check_trial_outputs(film, options.render, options.json, options.report);

    Cost sweep(options, film);
    if (sweep.light_references() && sweep.try_fixed() && sweep.try_coupled()) sweep.complete();
    const Sweep& found = sweep.sweep();
    if (found.fixed.empty() && found.pairs.empty()) return interrupted();

    ErrorCollector errors;
    if (options.json) errors.attempt([&] { write_json(*options.json, cost_json(sweep.film(), found, command)); });
    if (options.report) errors.attempt([&] { write_cost_report(*options.report, sweep.film(), found, command); });
    if (!quiet) errors.attempt([&] { print_sentence(sentence_of(found, sweep.film().coding.quantiser)); });
    if (!found.complete && !quiet) print_line("interrupted: this is a part of the table");
    errors.rethrow();
    return found.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
