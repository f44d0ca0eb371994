#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/experiments/reference_cache.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/report.h"
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

using nlohmann::json;

/// The share as typed, without a float's further digits.
double plain(float share) {
    return std::stod(fmt::format("{:.6g}", share));
}

json row_json(const Trial& t) {
    json decoded = quality_json(t.decoded.psnr_y(), t.decoded.ssim_y());
    decoded["psnr_hvs_m"] = finite_or_null(t.psnr_hvs_m());
    return {{"tolerance", t.tolerance.coupled ? json("coupled") : json(plain(t.tolerance.relative))},
            {"quantiser", t.quantiser},
            {"seconds", t.seconds},
            {"requantised", t.requantised},
            {"points", t.points},
            {"rays_per_point", t.rays},
            {"cut", t.cut},
            {"capped", t.capped},
            {"error",
             {{"p50", finite_or_null(t.errors.quantile(0.5))},
              {"p95", finite_or_null(t.errors.quantile(0.95))},
              {"p99", finite_or_null(t.errors.quantile(0.99))},
              {"over_tolerance", t.share_over()},
              {"over_twice", t.share_over_twice()},
              {"pixels", t.errors.count()}}},
            {"lit", quality_json(t.lit.psnr_y(), t.lit.ssim_y())},
            {"decoded", decoded},
            {"bytes", t.bytes}};
}

json pair_json(const CoupledPair& pair) {
    const auto or_null = [](const std::optional<double>& value) { return value ? json(*value) : json(nullptr); };
    return {{"coupled", row_json(pair.coupled)},
            {"fixed", row_json(pair.fixed)},
            {"time_ratio", or_null(pair.time_ratio())},
            {"psnr_y_loss", or_null(pair.psnr_loss())},
            {"ssim_y_loss", pair.ssim_loss()}};
}

Curve curve_of(const std::string& name, const std::string& color) {
    return {name, color, {}};
}

const CurveAxis seconds_axis{"CPU seconds of light per frame", true};

CurvePlot quality_plot(const Sweep& sweep, int quantiser) {
    CurvePlot plot{"Quality of the decoded film over time", seconds_axis, {"PSNR-Y, dB", false}, {}};
    Curve fixed = curve_of("fixed tolerance", "one"), coupled = curve_of("coupled", "i");
    for (const Trial& t : sweep.fixed)
        fixed.points.push_back({t.seconds, t.decoded.psnr_y(), tolerance_text(t.tolerance.relative), false});
    for (const CoupledPair& pair : sweep.pairs)
        if (pair.coupled.quantiser == quantiser)
            coupled.points.push_back({pair.coupled.seconds, pair.coupled.decoded.psnr_y(), "coupled", false});
    plot.curves = {fixed, coupled};
    return plot;
}

CurvePlot error_plot(const Sweep& sweep) {
    CurvePlot plot{"True error of a pixel's light over time", seconds_axis, {"error, %", true}, {}};
    Curve high = curve_of("95 of 100 pixels err by no more than", "one"),
          middle = curve_of("half of the pixels", "two");
    for (const Trial& t : sweep.fixed) {
        high.points.push_back({t.seconds, 100 * t.errors.quantile(0.95), tolerance_text(t.tolerance.relative), false});
        middle.points.push_back({t.seconds, 100 * t.errors.quantile(0.5), "", false});
    }
    plot.curves = {high, middle};
    return plot;
}

/// Coupled light and a fixed 2 %, one figure over another.
template <class X, class Y>
CurvePlot pair_plot(const Sweep& sweep, CurvePlot plot, X&& x, Y&& y) {
    Curve coupled = curve_of("coupled", "i"), fixed = curve_of("fixed 2 %", "one");
    for (const CoupledPair& pair : sweep.pairs) {
        coupled.points.push_back({x(pair.coupled), y(pair.coupled), "", false});
        fixed.points.push_back({x(pair.fixed), y(pair.fixed), fmt::format("q {}", pair.fixed.quantiser), false});
    }
    plot.curves = {coupled, fixed};
    return plot;
}

std::string plots(const Sweep& sweep, int quantiser) {
    std::string text = figure_of(quality_plot(sweep, quantiser)) + figure_of(error_plot(sweep));
    text += figure_of(pair_plot(
        sweep,
        {"Time for light over the quantiser it is coupled to", {"quantiser", true}, {"CPU s per frame", true}, {}},
        [](const Trial& t) { return static_cast<double>(t.quantiser); }, [](const Trial& t) { return t.seconds; }));
    text += figure_of(pair_plot(
        sweep, {"Quality over size", {"bytes per frame", true}, {"PSNR-Y, dB", false}, {}},
        [](const Trial& t) { return t.bytes; }, [](const Trial& t) { return t.decoded.psnr_y(); }));
    return text.empty() ? "" : "<h2>Curves</h2>\n" + text;
}

TableRow table_row(const std::string& name, const Trial& t) {
    return {{name, short_figure(t.seconds), count_text(t.rays), count_text(t.cut),
             short_figure(100 * t.errors.quantile(0.5)), short_figure(100 * t.errors.quantile(0.95)),
             short_figure(100 * t.share_over()), short_figure(100 * t.share_over_twice()),
             psnr_text(t.decoded.psnr_y()), fmt::format("{:.4f}", t.decoded.ssim_y()), psnr_text(t.psnr_hvs_m()),
             fmt::format("{:.0f}", t.bytes)}};
}

std::string table_of(const std::string& title, const std::string& first, const std::vector<TableRow>& rows) {
    if (rows.empty()) return {};
    return html_table(title, "tnnnnnnnnnnn",
                      {first, "CPU, s", "Rays", "Cut", "Median, %", "95th, %", "Over, %", "Twice, %", "PSNR-Y", "SSIM",
                       "HVS-M", "Bytes"},
                      rows);
}

std::string tables(const Sweep& sweep, int quantiser) {
    std::vector<TableRow> fixed, pairs;
    for (const Trial& t : sweep.fixed) fixed.push_back(table_row(tolerance_text(t.tolerance.relative), t));
    for (const CoupledPair& pair : sweep.pairs) {
        pairs.push_back(table_row(fmt::format("{}, coupled", pair.coupled.quantiser), pair.coupled));
        pairs.push_back(table_row(fmt::format("{}, 2 %", pair.fixed.quantiser), pair.fixed));
    }
    return table_of(fmt::format("Fixed tolerances, coded with quantiser {}", quantiser), "Tolerance", fixed) +
           table_of("Coupled to the quantiser, and a fixed 2 % coded with it", "Quantiser", pairs) +
           "<p class=\"soft\">CPU: seconds of all threads for light, per frame. Rays: shadow rays and gather rays per "
           "gather point; cut: clusters of lights per point. Median and 95th percentile of the error of a pixel's "
           "luminance against reference light. Over: share of the pixels that err by more than their tolerance; twice: "
           "by more than twice of it. PSNR-Y, SSIM and PSNR-HVS-M (HVS-M): decoded pictures against pictures in "
           "reference light that are not coded. Bytes per frame.</p>\n";
}

/// The film's own quantiser (or the nearest tried) beside the loosest fixed tolerance.
std::string views(const RenderJob& film, const Sweep& sweep) {
    const auto nearest =
        std::min_element(sweep.pairs.begin(), sweep.pairs.end(), [&](const CoupledPair& a, const CoupledPair& b) {
            return std::abs(a.coupled.quantiser - film.coding.quantiser) <
                   std::abs(b.coupled.quantiser - film.coding.quantiser);
        });
    std::string text;
    if (nearest != sweep.pairs.end())
        text += sample_frame_figures(fmt::format("coupled, quantiser {}", nearest->coupled.quantiser), nearest->coupled,
                                     film);
    if (!sweep.fixed.empty())
        text += sample_frame_figures("fixed " + tolerance_text(sweep.fixed.front().tolerance.relative),
                                     sweep.fixed.front(), film);
    return text.empty() ? "" : "<h2>Side by side</h2>\n" + text;
}

std::string cards(const RenderJob& film, const Sweep& sweep) {
    std::int64_t frames = 0;
    for (const Chunk& window : sweep.windows) frames += window.frames();
    return cards_of({{"Size", fmt::format("{} x {}", film.format.width, film.format.height)},
                     {"Frames tried", fmt::format("{} in {} windows", frames, sweep.windows.size())},
                     {"Light points", fmt::format("{} + {}", sweep.direct_points, sweep.indirect_points)},
                     {"References", fmt::format("{}", sweep.references)},
                     {"CPU time of one", short_figure(sweep.reference_seconds) + " s"}});
}

json film_json(const std::vector<FilmCost>& rows) {
    json film = json::array();
    const std::optional<std::size_t> taken = recommended(rows);
    for (std::size_t i = 0; i < rows.size(); ++i)
        film.push_back({{"option", rows[i].option},
                        {"value", rows[i].value},
                        {"clock", rows[i].clock},
                        {"cpu", rows[i].cpu},
                        {"bytes", rows[i].bytes},
                        {"difference", words_for(rows[i].added)},
                        {"added_psnr_hvs_m", rows[i].added ? finite_or_null(*rows[i].added) : json(nullptr)},
                        {"psnr_y_loss", rows[i].psnr_loss},
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

std::string first_screen(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& rows) {
    const std::optional<std::size_t> taken = recommended(rows);
    if (!taken) return {};
    const std::string note = fmt::format(
        "Times are of this machine's {} threads, as busy as it was. From {} sample frame{} of {}x{}, "
        "quantiser {}. Words: what light adds to the error that one sees (PSNR-HVS-M of 50, 46, 42 dB). "
        "dB: PSNR-Y after coding, below the most exact tolerance.",
        parallel::thread_count(), sweep.fixed.front().frames, sweep.fixed.front().frames == 1 ? "" : "s",
        film.format.width, film.format.height, film.coding.quantiser);
    std::string figure;
    if (const auto& own = sweep.fixed.front().sample_frame)
        figure = difference_figure(
            fmt::format("Frame {}, before coding: the loosest light beside the most exact", own->frame),
            {"fixed=" + tolerance_text(sweep.fixed.front().tolerance.relative), own->lit}, {"exact", own->truth},
            perceptual::matrix_for(film.format.height));
    return answer_screen(
        answer_table({"accuracy of light", "time, whole film", "difference", "film"}, answer_rows(rows), note), figure,
        sweep.render);
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

json cost_json(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& rows,
               const std::string& command) {
    json fixed = json::array(), coupled = json::array();
    for (const Trial& trial : sweep.fixed) fixed.push_back(row_json(trial));
    for (const CoupledPair& pair : sweep.pairs) coupled.push_back(pair_json(pair));
    json all = trial_json(film, command, sweep.windows, sweep.references, sweep.reference_seconds);
    all.update(light_json(film));
    all.update({{"exposure", film.exposure.value_or(0)},
                {"view", core::text_of(film.view)},
                {"light_points", {{"direct", sweep.direct_points}, {"indirect", sweep.indirect_points}}},
                {"quantiser", film.coding.quantiser},
                {"fixed", fixed},
                {"coupled", coupled},
                {"film", film_json(rows)},
                {"render", sweep.render.empty() ? json(nullptr) : json(sweep.render)},
                {"effects", effects_json(sweep.effects)},
                {"summary", answer_of(rows, film)},
                {"complete", sweep.complete}});
    return all;
}

void write_cost_report(const std::filesystem::path& html, const RenderJob& film, const Sweep& sweep,
                       const std::vector<FilmCost>& rows, const std::string& command) {
    const int quantiser = film.coding.quantiser;
    std::string body = first_screen(film, sweep, rows);
    body += effects_section(sweep.effects, perceptual::matrix_for(film.format.height));
    body += folded("All curves and tables: rays, cuts, percentiles, quantisers",
                   cards(film, sweep) + plots(sweep, quantiser) + views(film, sweep) + tables(sweep, quantiser));
    const std::string lead = (sweep.complete ? "" : "Interrupted: this is a part of it. ") + answer_of(rows, film);
    write_trial_page(html, film, "what accuracy costs", lead, body, command, "docs/json.md",
                     cost_json(film, sweep, rows, command));
}

}  // namespace render2mpeg::app
