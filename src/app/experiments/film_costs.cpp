#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/report/figures.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// "-0.62 dB"; empty where two digits show nothing.
std::string loss_text(const FilmCost& cost) {
    return cost.psnr_loss < 0.005 ? "" : fmt::format("-{:.2f} dB", cost.psnr_loss);
}

/// [Ponomarenko2007]: below some 42 dB differences are seen. chosen: 4 and 8 dB more for errors that are not even.
constexpr double invisible = 50, hardly = 46, slight = 42;

double difference(double loss) {
    return std::isfinite(loss) ? loss : 0;
}

/// Seconds on the clock for one of CPU: over all rows, so that a machine that is busy for a while favours none.
double pace_of(const Sweep& sweep) {
    double clock = 0, cpu = 0;
    const auto add = [&](const Trial& trial) {
        clock += trial.clock;
        cpu += trial.cpu;
    };
    for (const Trial& trial : sweep.fixed) add(trial);
    for (const CoupledPair& pair : sweep.pairs) add(pair.coupled);
    return core::divide_or(clock, cpu, 1.0 / std::max(1, parallel::thread_count()));
}

FilmCost cost_of(const std::string& name, const Trial& trial, const Trial& best, const RenderJob& film, double once,
                 double pace) {
    const auto frames = static_cast<double>(film.frame_count());
    FilmCost cost{name, once + pace * trial.cpu * frames, trial.cpu * frames, trial.bytes_in_film() * frames, {}, 0,
                  false};
    const double added = trial.masked_error - best.masked_error;
    if (added > 0) cost.added = perceptual::psnr(added);
    cost.psnr_loss = std::max(0.0, difference(best.decoded.psnr_y() - trial.decoded.psnr_y()));
    return cost;
}

/// CPU seconds of a frame that every light point lights: as the most exact row, but for its light.
double reference_cpu(const Sweep& sweep, const Trial& best) {
    return std::max(best.cpu, best.cpu + sweep.reference_seconds - best.window_seconds);
}

/// The row that is lit as the film was asked for, or nearly so.
const Trial& as_asked(const Sweep& sweep, const RenderJob& film) {
    if (film.tolerance.coupled)
        for (const CoupledPair& pair : sweep.pairs)
            if (pair.coupled.quantiser == film.coding.quantiser) return pair.coupled;
    const float share = film.tolerance.coupled ? 0.02f : film.tolerance.relative;
    return *std::min_element(sweep.fixed.begin(), sweep.fixed.end(), [&](const Trial& a, const Trial& b) {
        return std::abs(a.tolerance.relative - share) < std::abs(b.tolerance.relative - share);
    });
}

/// By how much the film's size, where it is known, differs from what the sample comes to.
double size_ratio(const Sweep& sweep, const RenderJob& film) {
    if (!sweep.asked || sweep.asked->bytes <= 0) return 1;
    return core::divide_or(sweep.asked->bytes,
                           as_asked(sweep, film).bytes_in_film() * static_cast<double>(film.frame_count()), 1.0);
}

}  // namespace

std::string words_for(const std::optional<double>& added) {
    if (!added || *added >= invisible) return "none you can see";
    if (*added >= hardly) return "hardly any";
    return *added >= slight ? "slight in flat areas" : "visible";
}

Grade grade_of(const std::optional<double>& added) {
    if (!added || *added >= hardly) return Grade::good;
    return *added >= slight ? Grade::fair : Grade::poor;
}

std::vector<FilmCost> film_costs(const Sweep& sweep, const RenderJob& film) {
    std::vector<FilmCost> costs;
    if (sweep.fixed.empty()) return costs;
    const Trial& best = sweep.fixed.back();
    const double once = sweep.once, pace = pace_of(sweep);
    for (const Trial& trial : sweep.fixed)
        costs.push_back(
            cost_of(fmt::format("fixed={:.4g}%", 100 * trial.tolerance.relative), trial, best, film, once, pace));
    for (const CoupledPair& pair : sweep.pairs)
        if (pair.coupled.quantiser == film.coding.quantiser) {
            Trial coupled = pair.coupled;
            if (sweep.asked && film.tolerance.coupled) coupled.cpu = std::max(coupled.cpu, sweep.asked->later);
            costs.push_back(cost_of("coupled", coupled, best, film, once, pace));
        }
    if (sweep.references > 0) {
        const auto frames = static_cast<double>(film.frame_count());
        const double cpu = reference_cpu(sweep, best) * frames;
        costs.push_back({"reference", once + pace * cpu, cpu, best.bytes_in_film() * frames, {}, 0, true});
    }
    const double ratio = size_ratio(sweep, film);
    for (FilmCost& cost : costs) cost.bytes *= ratio;
    std::stable_sort(costs.begin(), costs.end(), [](const FilmCost& a, const FilmCost& b) { return a.cpu < b.cpu; });
    return costs;
}

std::optional<FilmCost> draft_cost(const Sweep& sweep, const RenderJob& film) {
    if (!sweep.draft || sweep.fixed.empty()) return {};
    FilmCost cost = cost_of("draft", *sweep.draft, sweep.fixed.back(), film, sweep.once, pace_of(sweep));
    cost.bytes *= size_ratio(sweep, film);
    return cost;
}

std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs) {
    std::vector<Offer> offers;
    for (const FilmCost& cost : costs) offers.push_back({cost.cpu, !cost.added || *cost.added >= invisible});
    return cheapest_alike(offers);
}

std::string answer_of(const std::vector<FilmCost>& costs, const RenderJob& film) {
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return {};
    const FilmCost& here = costs[*taken];
    return fmt::format(
        "Take {}: your film of {} frames takes about {} and has about {}; the difference from exact "
        "light: {}.",
        here.name, film.frame_count(), time_text(here.clock, here.cpu), size_text(here.bytes), words_for(here.added));
}

std::string film_cost_table(const std::vector<FilmCost>& costs, const std::optional<FilmCost>& draft) {
    const std::optional<std::size_t> taken = recommended(costs);
    const auto line = [](const FilmCost& cost, const char* mark) {
        return fmt::format("{:<12} {:>7} {:>7.0f} {:>9}  {}{}{}\n", cost.name, clock_text(cost.clock), cost.cpu,
                           size_text(cost.bytes), words_for(cost.added),
                           loss_text(cost).empty() ? "" : " (" + loss_text(cost) + ")", mark);
    };
    std::string text =
        fmt::format("\nThe whole film on this machine's {} threads\n{:<12} {:>7} {:>7} {:>9}  {}\n",
                    parallel::thread_count(), "--tolerance", "clock", "CPU, s", "size", "difference from exact light");
    if (draft) text += line(*draft, "");
    for (std::size_t i = 0; i < costs.size(); ++i) text += line(costs[i], taken == i ? " <- take this" : "");
    return text;
}

std::vector<AnswerRow> answer_rows(const std::vector<FilmCost>& costs, const std::optional<FilmCost>& draft) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::vector<AnswerRow> rows;
    double longest = draft ? draft->cpu : 0.0;
    for (const FilmCost& c : costs) longest = std::max(longest, c.cpu);
    const auto add = [&](const FilmCost& c, const std::string& name, bool is_taken) {
        rows.push_back({name, core::divide_or(c.cpu, longest, 0.0), time_text(c.clock, c.cpu), words_for(c.added),
                        grade_of(c.added), loss_text(c), size_text(c.bytes), is_taken});
    };
    if (draft && !costs.empty()) add(*draft, "draft (--preview)", false);
    for (std::size_t i = 0; i < costs.size(); ++i)
        add(costs[i], costs[i].is_reference ? "reference (exact)" : costs[i].name, taken == i);
    return rows;
}

}  // namespace render2mpeg::app
