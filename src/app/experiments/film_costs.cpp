#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/experiments/reference_cache.h"
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

/// The row with the film's own settings, or the nearest.
const Trial& as_asked(const Sweep& sweep, const RenderJob& film) {
    if (film.tolerance.coupled)
        for (const CoupledPair& pair : sweep.pairs)
            if (pair.coupled.quantiser == film.coding.quantiser) return pair.coupled;
    const float share = film.tolerance.coupled ? 0.02f : film.tolerance.relative;
    return *std::min_element(sweep.fixed.begin(), sweep.fixed.end(), [&](const Trial& a, const Trial& b) {
        return std::abs(a.tolerance.relative - share) < std::abs(b.tolerance.relative - share);
    });
}

struct Base {
    double cpu = 0, bytes = 0;  ///< of the film, for one of the sample's frame
    double pace = 0;            ///< seconds on the clock for one of CPU
};

Base base_of(const Sweep& sweep, const RenderJob& film) {
    const Trial& asked = as_asked(sweep, film);
    const auto frames = static_cast<double>(film.frame_count());
    if (!sweep.forecast) {
        // Mean pace of all rows, since the machine's load changes.
        double clock = 0, cpu = 0;
        for (const Trial& trial : sweep.fixed) clock += trial.clock, cpu += trial.cpu;
        return {frames, frames, core::divide_or(clock, cpu, 1.0)};
    }
    const Forecast& f = *sweep.forecast;
    return {core::divide_or(f.cpu, asked.cpu, frames), core::divide_or(f.bytes, asked.bytes_in_film(), frames),
            core::divide_or(f.clock, f.cpu, 1.0)};
}

/// CPU seconds of a reference frame: the most exact row's, with the reference's light.
double reference_cpu(const Sweep& sweep, const Trial& best) {
    return std::max(best.cpu, best.cpu + sweep.reference_seconds - best.seconds);
}

std::string percent(double share) {
    return short_figure(100 * share);
}

std::string columns(const std::string& name, const char* first) {
    return fmt::format("{:<9}{}\n{:<9}{:>7} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>6} {:>6} {:>8}\n", "",
                       "  light           cut  error, %     pixels over, %", name, first, "rays", "size", "median",
                       "95 %", "it", "twice", "PSNR-Y", "SSIM", "size");
}

std::string row(const std::string& name, const Trial& t) {
    // The quantiser of a rate-controlled film says little.
    const std::string note = t.requantised == 0
                                 ? ""
                                 : fmt::format("{:<9}{} of {} pictures coded coarser than that, to fit the buffer\n",
                                               "", t.requantised, t.frames);
    return fmt::format("{:<9}{:>7} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>6} {:.4f} {:>8}\n", name,
                       short_figure(t.seconds), count_text(t.rays), count_text(t.cut), percent(t.errors.quantile(0.5)),
                       percent(t.errors.quantile(0.95)), percent(t.share_over()), percent(t.share_over_twice()),
                       psnr_text(t.decoded.psnr_y()), t.decoded.ssim_y(), size_text(t.bytes)) +
           note;
}

}  // namespace

std::optional<double> CoupledPair::time_ratio() const {
    if (!(coupled.seconds > 0 && fixed.seconds > 0) || fixed.points == 0) return std::nullopt;
    return coupled.seconds / fixed.seconds;
}

std::optional<double> CoupledPair::psnr_loss() const {
    const double loss = fixed.decoded.psnr_y() - coupled.decoded.psnr_y();
    return std::isfinite(loss) ? std::optional(loss) : std::nullopt;
}

std::string tolerance_text(float share) {
    return fmt::format("{:.4g} %", 100 * share);
}

std::string short_figure(double value) {
    if (!std::isfinite(value)) return "-";
    if (value >= 999.5) return fmt::format("{:.0f}", value);
    if (value < 0.0005) return "0";
    const int digits = value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f}", value, value < 0.095 ? 3 : digits);
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

std::vector<FilmCost> film_costs(const Sweep& sweep, const RenderJob& film) {
    std::vector<FilmCost> costs;
    if (sweep.fixed.empty()) return costs;
    const Trial& best = sweep.fixed.back();
    const Base base = base_of(sweep, film);
    const auto add = [&](const char* option, const std::string& value, const Trial& trial, double frame) {
        const double added = trial.masked_error - best.masked_error;
        costs.push_back({option, value, base.pace * base.cpu * frame, base.cpu * frame,
                         base.bytes * trial.bytes_in_film(),
                         added > 0 ? std::optional(perceptual::psnr(added)) : std::nullopt,
                         std::max(0.0, difference(best.decoded.psnr_y() - trial.decoded.psnr_y()))});
    };
    for (const Trial& trial : sweep.fixed)
        add("--tolerance", fmt::format("fixed={:.4g}%", 100 * trial.tolerance.relative), trial, trial.cpu);
    for (const CoupledPair& pair : sweep.pairs)
        if (pair.coupled.quantiser == film.coding.quantiser)
            add("--tolerance", "coupled", pair.coupled, pair.coupled.cpu);
    for (const auto& [name, trial] : sweep.efforts) add("--effort", name, trial, trial.cpu);
    if (sweep.references > 0) {
        add("--tolerance", "reference", best, reference_cpu(sweep, best));
        costs.back().added.reset();
        costs.back().psnr_loss = 0;
    }
    std::stable_sort(costs.begin(), costs.end(), [](const FilmCost& a, const FilmCost& b) { return a.cpu < b.cpu; });
    return costs;
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
        "Take {}: your film of {} frames takes about {} and has about {}; the difference from exact light: {}.",
        here.name(), film.frame_count(), time_text(here.clock, here.cpu), size_text(here.bytes), words_for(here.added));
}

std::string film_cost_table(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::string text =
        fmt::format("\nThe whole film on this machine's {} threads\n{:<14} {:>7} {:>7} {:>9}  {}\n",
                    parallel::thread_count(), "setting", "clock", "CPU, s", "size", "difference from exact light");
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const FilmCost& cost = costs[i];
        const std::string loss = loss_text(cost);
        text += fmt::format("{:<14} {:>7} {:>7.0f} {:>9}  {}{}{}\n", cost.name(), clock_text(cost.clock), cost.cpu,
                            size_text(cost.bytes), words_for(cost.added), loss.empty() ? "" : " (" + loss + ")",
                            taken == i ? " <- take" : "");
    }
    return text;
}

std::vector<AnswerRow> answer_rows(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::vector<AnswerRow> rows;
    double longest = 0;
    for (const FilmCost& c : costs) longest = std::max(longest, c.cpu);
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const FilmCost& c = costs[i];
        rows.push_back({c.value == "reference" ? "reference (exact)" : c.name(), core::divide_or(c.cpu, longest, 0.0),
                        time_text(c.clock, c.cpu), words_for(c.added), grade_of(c.added), loss_text(c),
                        size_text(c.bytes), taken == i});
    }
    return rows;
}

std::string cost_heading(const RenderJob& film, const Sweep& sweep) {
    std::string frames;
    int count = 0;
    for (const Chunk& window : sweep.windows) {
        count += static_cast<int>(window.frames());
        if (&window - sweep.windows.data() < 4)
            frames += (frames.empty() ? "" : ", ") + (window.first == window.last
                                                          ? fmt::format("{}", window.first)
                                                          : fmt::format("{} to {}", window.first, window.last));
        else if (&window - sweep.windows.data() == 4)
            frames += ", ...";
    }
    return fmt::format("{}: {} frame{} of {}x{} ({}); {} by {} as reference\n", film.animation->source, count,
                       count == 1 ? "" : "s", film.format.width, film.format.height, frames, sweep.references,
                       reference_light(film, sweep.direct_points + sweep.indirect_points)) +
           fmt::format("reference light: {} s of CPU per frame\n", short_figure(sweep.reference_seconds));
}

std::string fixed_heading(int quantiser) {
    return fmt::format("\nFixed tolerances, coded with quantiser {}. Light: CPU seconds per frame, rays per\n",
                       quantiser) +
           "point; PSNR-Y and SSIM: decoded, against reference light before coding.\n" + columns("fixed", "s");
}

std::string fixed_row(const Trial& trial) {
    return row(tolerance_text(trial.tolerance.relative), trial);
}

std::string pair_heading() {
    return "\nCoupled to the quantiser, and a fixed 2 % coded with it.\n" + columns("quantiser", "s");
}

std::string pair_rows(const CoupledPair& pair) {
    std::string text =
        row(fmt::format("{:>2} coup.", pair.coupled.quantiser), pair.coupled) + row("    2 %", pair.fixed);
    const std::optional<double> ratio = pair.time_ratio(), loss = pair.psnr_loss();
    if (!ratio) return text;
    text += fmt::format("{:<9}{:.2f} times the time", "", *ratio);
    if (loss) text += fmt::format(", {:+.2f} dB PSNR-Y, {:+.4f} SSIM", -*loss, -pair.ssim_loss());
    return text + "\n";
}

}  // namespace render2mpeg::app
