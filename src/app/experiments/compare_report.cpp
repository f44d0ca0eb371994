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

/// Who wins, and by how much.
std::vector<AnswerRow> winners(const Comparison& found, const std::vector<WayCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::vector<AnswerRow> rows;
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const WayCost& cost = costs[i];
        const std::string change =
            cost.way == coupled_way ? "the measure" : change_text(100 * (cost.bits - 1)) + " bits";
        const double beyond = cost.bits / costs.front().bits;
        const Grade grade = beyond < 1.01 ? Grade::good : beyond < 1.1 ? Grade::fair : Grade::poor;
        rows.push_back({found.ways[cost.way].name, cost.bits / costs.back().bits,
                        fmt::format("{:.0f} %", 100 * cost.bits), change, grade, "at equal PSNR-Y",
                        time_text(cost.clock, cost.cpu), taken == i});
    }
    return rows;
}

std::string first_screen(const RenderJob& film, const Comparison& found) {
    if (!found.complete || found.ways[coupled_way].rows.empty()) return {};
    const auto& rows = found.ways[coupled_way].rows;
    const std::size_t row = row_of(found, film.coding.quantiser);
    const std::vector<WayCost> costs = way_costs(found, film.frame_count(), row);
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
    return answer_screen(
        answer_table({"way", "bits, coupled = 100 %", "difference", "time, whole film"}, winners(found, costs), note),
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
                {"answer", answer_of(found, film.frame_count(), film.coding.quantiser)},
                {"render", found.render.empty() ? json(nullptr) : json(found.render)},
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
        found.complete ? answer_of(found, film.frame_count(), film.coding.quantiser) + " " + sentence_of(found)
                       : "Interrupted: this is a part of it.";
    write_trial_page(html, film, "coupled, or rendered first", lead, body, command, "docs/json.md",
                     compare_json(film, found, command));
}

}  // namespace render2mpeg::app
