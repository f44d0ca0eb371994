#include "app/experiments/cost_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/experiments/effect_costs.h"
#include "app/experiments/trial_page.h"
#include "app/files/file_io.h"
#include "app/report/answer.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/report.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

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
