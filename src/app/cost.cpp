#include "app/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/attempts.h"
#include "app/cost_report.h"
#include "app/cost_table.h"
#include "app/help_format.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/publish.h"
#include "app/render.h"
#include "app/report.h"
#include "app/statistics_json.h"
#include "app/terminal.h"
#include "app/text_file.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

void check_outputs(const Production& film, const CostOptions& options) {
    std::vector<Files> outputs{options.json.value_or("")};
    if (options.report) {
        check_report(*options.report);
        outputs.emplace_back(*options.report);
        outputs.emplace_back(report_json_of(*options.report));
    }
    check_apart(inputs_of(film, options.render), outputs);
    for (const Files& output : outputs)
        if (!output.name.empty()) check_writable(output.name);
}

/// One command in the making: rows are told as they come.
class Cost {
  public:
    Cost(const CostOptions& options, const Production& film)
        : options_(options), trials_(film, windows_of(film.frames, sample_from(options.sample))) {
        sweep_.windows = trials_.windows();
    }

    /// Returns whether nobody interrupted.
    bool light_references();
    bool try_fixed();
    bool try_coupled();
    void complete() { sweep_.complete = true; }

    const Sweep& sweep() const { return sweep_; }
    const Production& film() const { return trials_.film(); }

  private:
    bool is_quiet() const { return options_.render.quiet; }
    void say(const std::string& text) const {
        if (!is_quiet()) print(text);
    }
    std::optional<Trial> run(const ToleranceRequest& tolerance, int quantiser, const std::string& name,
                             LitWindows* keep);

    const CostOptions& options_;
    Trials trials_;
    Sweep sweep_;
    LitWindows usual_;  ///< lit by a fixed 2 %
};

bool Cost::light_references() {
    std::unique_ptr<Progress> progress;
    const bool whole = trials_.light_references([&](const ReferenceStanding& standing) {
        if (!progress) {
            if (!is_quiet() && standing.seconds_left() > 1)
                std::fputs(fmt::format("lighting {} by every light point takes about {}; interrupt to leave it\n",
                                       standing.parts == 1 ? "the reference" : "the references",
                                       clock_text(standing.seconds + standing.seconds_left()))
                               .c_str(),
                           stderr);
            progress = std::make_unique<Progress>(standing.parts, is_quiet(), "reference", Counted::parts_of_step,
                                                  standing.seconds);
        }
        progress->advance();
        return !InterruptGuard::requested();
    });
    progress.reset();
    const renderer::Statistics& statistics = trials_.statistics();
    sweep_.direct_points = statistics.direct_points;
    sweep_.indirect_points = statistics.indirect_points;
    sweep_.references = trials_.references();
    sweep_.reference_seconds = trials_.reference_seconds();
    if (whole) say(cost_heading(film(), sweep_));
    return whole;
}

std::optional<Trial> Cost::run(const ToleranceRequest& tolerance, int quantiser, const std::string& name,
                               LitWindows* keep) {
    // A log has the rows themselves.
    Progress progress(trials_.frames(), is_quiet() || !can_rewrite_errors(), name, Counted::frames_of_step);
    return trials_.run(
        tolerance, quantiser,
        [&] {
            progress.advance();
            return !InterruptGuard::requested();
        },
        keep);
}

bool Cost::try_fixed() {
    const int quantiser = film().coding.quantiser;
    say(fixed_heading(quantiser));
    for (const float share : percents_from(options_.tolerances)) {
        const bool keep = share == 0.02f && usual_.frames.empty();
        const auto trial =
            run({false, share, false, {}}, quantiser, "fixed " + tolerance_text(share), keep ? &usual_ : nullptr);
        if (!trial) return false;
        sweep_.fixed.push_back(*trial);
        say(fixed_row(*trial));
    }
    return true;
}

bool Cost::try_coupled() {
    const std::vector<int> quantisers = quantisers_from(options_.quantisers);
    if (quantisers.empty()) return true;
    if (usual_.frames.empty() && !run({}, film().coding.quantiser, "fixed 2 %", &usual_)) return false;
    say(pair_heading());
    for (const int quantiser : quantisers) {
        const auto coupled =
            run({false, 0, true, {}}, quantiser, fmt::format("coupled, quantiser {}", quantiser), nullptr);
        if (!coupled) return false;
        sweep_.pairs.push_back({*coupled, trials_.coded_again(usual_, quantiser)});
        say(pair_rows(sweep_.pairs.back()));
    }
    return true;
}

}  // namespace

int cost(const CostOptions& options, const std::string& command) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    Production film = prepare(options.render);
    const bool quiet = options.render.quiet;
    for (const std::string& note : film.animation->notes)
        if (!quiet && !note.empty()) std::fputs((note + "\n").c_str(), stderr);
    check_outputs(film, options);
    if (!film.exposure) film.exposure = measure_exposure(film);

    Cost sweep(options, film);
    if (sweep.light_references() && sweep.try_fixed() && sweep.try_coupled()) sweep.complete();
    const Sweep& found = sweep.sweep();
    if (found.fixed.empty() && found.pairs.empty()) {
        if (!quiet) std::fputs("interrupted before the first row: nothing was found out\n", stderr);
        return InterruptGuard::status();
    }

    Attempts attempts;
    if (options.json) attempts.attempt([&] { write_json(*options.json, cost_json(sweep.film(), found, command)); });
    if (options.report) attempts.attempt([&] { write_cost_report(*options.report, sweep.film(), found, command); });
    const std::string sentence = sentence_of(found, sweep.film().coding.quantiser);
    if (!quiet && !sentence.empty())
        attempts.attempt([&] { print("\n" + wrapped(sentence, std::clamp(columns_of_output(), 60, 110)) + "\n"); });
    if (!found.complete && !quiet) std::fputs("interrupted: this is a part of the table\n", stderr);
    attempts.rethrow();
    return found.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
