#include "app/experiments/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/experiments/quality.h"
#include "app/experiments/sweep.h"
#include "app/experiments/trial_page.h"
#include "app/files/text_file.h"
#include "app/report/answer.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/report.h"
#include "app/system/progress.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

json row_json(const Trial& t, const Times& times) {
    const Quality q = quality_of(t, true);
    return {{"quantiser", t.quantiser},
            {"light_runs", times.light},
            {"code_runs", times.code},
            {"flicker", t.flicker},
            {"light_seconds", t.seconds},
            {"light_window_seconds", t.window_seconds},
            {"requantised", t.requantised},
            {"code_seconds", t.code_seconds},
            {"bytes", t.bytes},
            {"psnr_y", finite_or_null(q.psnr_y)},
            {"ssim_y", q.ssim_y},
            {"psnr_hvs_m", finite_or_null(q.psnr_hvs_m)},
            {"at_references",
             {{"psnr_y", finite_or_null(t.decoded.psnr_y())},
              {"ssim_y", t.decoded.ssim_y()},
              {"psnr_hvs_m", finite_or_null(t.psnr_hvs_m())}}}};
}

json difference_json(const Way& way, const Way& from) {
    const Difference d = difference_of(way, from);
    return {{"way", way.name},
            {"against", from.name},
            {"bits",
             {{"psnr_y", finite_or_null(d.psnr_y)},
              {"ssim_y", finite_or_null(d.ssim_y)},
              {"psnr_hvs_m", finite_or_null(d.psnr_hvs_m)}}},
            {"time", finite_or_null(d.seconds)}};
}

json differences_json(const Comparison& found) {
    json all = json::array();
    if (!found.complete) return all;
    for (const auto& [way, from] : held_against) all.push_back(difference_json(found.ways[way], found.ways[from]));
    return all;
}

json foreign_json(const Comparison& found) {
    if (!found.foreign) return nullptr;
    const ForeignFilm& f = *found.foreign;
    return {{"film", f.name},
            {"width", f.width},
            {"height", f.height},
            {"pictures", f.pictures},
            {"compared", f.compared},
            {"bytes", f.bytes},
            {"psnr_y", finite_or_null(f.psnr_y)},
            {"ssim_y", f.ssim_y},
            {"psnr_hvs_m", finite_or_null(f.psnr_hvs_m)},
            {"bits_of_coupled", finite_or_null(bits_beside(found))}};
}

/// What the last reference shows at the coarsest quantiser, and what becomes of it.
std::string views(const RenderJob& film, const Comparison& found) {
    const std::vector<Trial>& rows = found.ways[coupled_way].rows;
    const std::size_t row = rows.size() - 1;
    std::string text = sample_frame_figures(fmt::format("coupled, quantiser {}", rows[row].quantiser), rows[row], film);
    const Way& other = found.ways[strongest_way];
    if (row < other.rows.size())
        text += decoded_pair(fmt::format("The same frame by {}, whose film has {:.2f} times the bytes", other.name,
                                         core::divide_or(other.rows[row].bytes, rows[row].bytes, 0.0)),
                             "coupled", rows[row], other.name, other.rows[row], film);
    return text.empty() ? "" : "<h2>Side by side</h2>\n" + text;
}

template <class X>
std::string plot(const Comparison& found, const std::string& title, const std::string& axis, X&& x) {
    constexpr const char* colors[] = {"i", "one", "two", "c3", "c4", "c5"};
    CurvePlot plot{title, {axis, true}, {"PSNR-Y, dB", false}, {}};
    for (std::size_t i = 0; i < found.ways.size(); ++i) {
        Curve curve{found.ways[i].name, colors[i], {}};
        for (const Trial& t : found.ways[i].rows)
            curve.points.push_back(
                {x(t), quality_of(t, true).psnr_y, i == coupled_way ? fmt::format("q {}", t.quantiser) : "", false});
        plot.curves.push_back(std::move(curve));
    }
    return figure_of(plot);
}

std::string tables(const Comparison& found) {
    const auto seconds = [](double middle, const std::vector<double>& runs) {
        const std::string figure = short_figure(middle);
        return runs.size() < 2 ? figure : fmt::format("{} \u00b1 {:.0f} %", figure, 50 * spread(runs));
    };
    std::vector<TableRow> rows, differences;
    for (const Way& way : found.ways)
        for (std::size_t i = 0; i < way.rows.size(); ++i) {
            const Trial& t = way.rows[i];
            const Quality q = quality_of(t, true);
            rows.push_back(
                {{way.name, std::to_string(t.quantiser), seconds(t.seconds, way.times[i].light),
                  seconds(t.code_seconds, way.times[i].code), fmt::format("{:.0f}", t.bytes), psnr_text(q.psnr_y),
                  fmt::format("{:.4f}", q.ssim_y), psnr_text(q.psnr_hvs_m), fmt::format("{:.3f}", t.flicker)}});
        }
    const std::string text =
        html_table("All figures", "tnnnnnnnn",
                   {"Way", "Quantiser", "Light, s", "Coding, s", "Bytes", "PSNR-Y", "SSIM", "HVS-M", "Flicker"}, rows);
    if (!found.complete) return text;
    for (const auto& [way, from] : held_against) {
        const Difference d = difference_of(found.ways[way], found.ways[from]);
        differences.push_back({{found.ways[way].name, found.ways[from].name, change_text(d.psnr_y),
                                change_text(d.ssim_y), change_text(d.psnr_hvs_m), change_text(d.seconds)}});
    }
    return text + html_table("At equal quality", "ttnnnn",
                             {"Way", "against", "Bits, PSNR-Y", "Bits, SSIM", "Bits, HVS-M", "Time, PSNR-Y"},
                             differences);
}

/// Seconds on the clock of the whole film by a way, at its quantiser in that row.
double film_clock(const RenderJob& film, const Comparison& found, std::size_t way, std::size_t row) {
    const Trial& trial = found.ways[way].rows[row];
    double frame = trial.clock;
    // Light of a fixed tolerance was timed with our coding.
    if (way != coupled_way && row < found.ways[fixed_way].rows.size())
        frame += trial.code_seconds - found.ways[fixed_way].rows[row].code_seconds;
    return frame * static_cast<double>(film.frame_count());
}

/// Who wins, and by how much: bits of every way at equal PSNR-Y, over those of coupled light, and the film's time with
/// the quantiser of that row.
std::vector<AnswerRow> winners(const RenderJob& film, const Comparison& found, std::size_t row) {
    std::vector<std::pair<std::size_t, double>> ways{{coupled_way, 1.0}};
    for (const std::size_t way : {fixed_way, usual_way, strongest_way, strongest_free_way}) {
        const Difference d = difference_of(found.ways[coupled_way], found.ways[way]);
        if (std::isfinite(d.psnr_y)) ways.emplace_back(way, 1 / (1 + d.psnr_y / 100));
    }
    std::stable_sort(ways.begin(), ways.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    std::vector<AnswerRow> rows;
    for (const auto& [way, bits] : ways) {
        const std::string change = way == coupled_way ? "the measure" : change_text(100 * (bits - 1)) + " bits";
        const Grade grade = bits < 1.01 ? Grade::good : bits < 1.1 ? Grade::fair : Grade::poor;
        rows.push_back({found.ways[way].name, bits / ways.back().second, fmt::format("{:.0f} %", 100 * bits), change,
                        grade, "at equal PSNR-Y", clock_text(film_clock(film, found, way, row)),
                        way == ways.front().first});
    }
    return rows;
}

/// The row of the film's own quantiser, or of the one nearest to it.
std::size_t own_row(const RenderJob& film, const Comparison& found) {
    const auto& rows = found.ways[coupled_way].rows;
    const auto away = [&](const Trial& t) { return std::abs(t.quantiser - film.coding.quantiser); };
    return static_cast<std::size_t>(
        std::min_element(rows.begin(), rows.end(), [&](const Trial& a, const Trial& b) { return away(a) < away(b); }) -
        rows.begin());
}

/// How long the film takes; empty where that is not known.
std::string time_sentence(const RenderJob& film, const Comparison& found) {
    if (!found.complete || found.ways[coupled_way].rows.empty()) return {};
    const std::size_t row = own_row(film, found);
    if (row >= found.ways[fixed_way].rows.size()) return {};
    return fmt::format(" Your film of {} frames takes about {} coupled, {} with a fixed 2 %.", film.frame_count(),
                       clock_text(film_clock(film, found, coupled_way, row)),
                       clock_text(film_clock(film, found, fixed_way, row)));
}

std::string first_screen(const RenderJob& film, const Comparison& found) {
    if (!found.complete || found.ways[coupled_way].rows.empty()) return {};
    const auto& rows = found.ways[coupled_way].rows;
    const std::size_t row = own_row(film, found);
    std::string figure;
    const Way& other = found.ways[usual_way];
    if (row < other.rows.size() && rows[row].sample_frame && other.rows[row].sample_frame)
        figure = difference_figure(
            fmt::format("Quantiser {}: decoded", rows[row].quantiser), {"coupled", rows[row].sample_frame->decoded},
            {other.name, other.rows[row].sample_frame->decoded}, perceptual::matrix_for(film.format.height));
    const std::string note = fmt::format(
        "Bits at equal PSNR-Y, over those of coupled light: means over quantisers {} to {}. Times are of this machine, "
        "as busy as it was, at quantiser {}. From {} sample frames.",
        rows.front().quantiser, rows.back().quantiser, rows[row].quantiser, rows.front().frames);
    return answer_screen(answer_table({"way", "bits, coupled = 100 %", "difference", "time, whole film"},
                                      winners(film, found, row), note),
                         figure, found.render);
}

std::string foreign_paragraph(const Comparison& found) {
    if (!found.foreign) return {};
    std::string text = foreign_lines(found);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return "<h2>A film by somebody else</h2>\n<p>" + escaped(text) + "</p>\n";
}

std::string commands(const Comparison& found) {
    std::vector<TableRow> rows;
    for (const Way& way : found.ways) rows.push_back({{way.name, way.how}});
    rows.push_back({{"version", found.ffmpeg}});
    return html_table("The ways", "tt", {}, rows);
}

}  // namespace

json compare_json(const RenderJob& film, const Comparison& found, const std::string& command) {
    json ways = json::array();
    for (const Way& way : found.ways) {
        json rows = json::array();
        for (std::size_t i = 0; i < way.rows.size(); ++i) rows.push_back(row_json(way.rows[i], way.times[i]));
        ways.push_back({{"name", way.name}, {"how", way.how}, {"rows", rows}});
    }
    json all = trial_json(film, command, found.windows, found.references, found.reference_seconds);
    all.update(light_json(film));
    all.update({{"ffmpeg", found.ffmpeg},
                {"gop", film.coding.gop},
                {"light_points", found.light_points},
                {"runs", found.runs},
                {"ways", ways},
                {"foreign", foreign_json(found)},
                {"differences", differences_json(found)},
                {"summary", sentence_of(found)},
                {"complete", found.complete}});
    return all;
}

void write_compare_report(const std::filesystem::path& html, const RenderJob& film, const Comparison& found,
                          const std::string& command) {
    std::string curves = plot(found, "Quality over size", "bytes per frame", [](const Trial& t) { return t.bytes; });
    curves += plot(found, "Quality over time for light, motion and coding", "CPU seconds per frame",
                   [](const Trial& t) { return t.seconds + t.code_seconds; });
    std::string body = first_screen(film, found);
    body += folded("All curves and tables", curves + views(film, found) + tables(found) + foreign_paragraph(found) +
                                                "<p class=\"soft\">Light: CPU seconds of all threads per frame; "
                                                "coding: with exact motion, or with ffmpeg's "
                                                "search for it on one thread. PSNR-Y, SSIM and PSNR-HVS-M (HVS-M): all "
                                                "decoded pictures against themselves as "
                                                "lit, with what light adds on those that were also lit by every light "
                                                "point. Flicker: what adjacent ones "
                                                "change "
                                                "along motion more than they should. At equal quality: mean "
                                                "differences over the qualities that both reach "
                                                "(Bjontegaard).</p>\n" +
                                                commands(found));
    const std::string lead =
        found.complete ? sentence_of(found) + time_sentence(film, found) : "Interrupted: this is a part of it.";
    write_trial_page(html, film, "coupled, or rendered first", lead, body, command, "docs/json.md",
                     compare_json(film, found, command));
}

}  // namespace render2mpeg::app
