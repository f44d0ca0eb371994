#include "app/experiments/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/experiments/film_costs.h"
#include "app/experiments/quality_search.h"
#include "app/experiments/reference_cache.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/report/answer.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/report.h"
#include "app/system/progress.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// SSIM in decibels.
double in_decibels(double ssim) {
    return -10 * std::log10(std::max(1 - ssim, 1e-9));
}

template <class Cost, class Quality>
double change(const Way& way, const Way& from, Cost&& cost, Quality&& quality) {
    const auto points = [&](const Way& w) {
        std::vector<RatePoint> all;
        for (const Trial& t : w.rows)
            if (cost(t) > 0 && std::isfinite(quality(t))) all.push_back({cost(t), quality(t)});
        return all;
    };
    return bd_rate(points(from), points(way));
}

double total_seconds(const Trial& t) {
    return t.seconds + t.code_seconds;
}

/// "12.3 % fewer", "3 % more"
std::string more_text(double per_cent) {
    return fmt::format("{:.1f} % {}", std::abs(per_cent), per_cent < 0 ? "fewer" : "more");
}

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

/// The last reference at the coarsest quantiser, by each way.
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

Difference difference_of(const Way& way, const Way& from) {
    const auto bytes = [](const Trial& t) { return t.bytes; };
    const auto psnr = [](const Trial& t) { return quality_of(t, true).psnr_y; };
    return {change(way, from, bytes, psnr),
            change(way, from, bytes, [](const Trial& t) { return in_decibels(quality_of(t, true).ssim_y); }),
            change(way, from, bytes, [](const Trial& t) { return quality_of(t, true).psnr_hvs_m; }),
            change(way, from, total_seconds, psnr)};
}

std::vector<WayCost> way_costs(const Comparison& found, std::int64_t frames, std::size_t row) {
    // Mean pace of all that was lit, since the machine's load changes.
    double clock = 0, cpu = 0;
    for (const std::size_t way : {coupled_way, fixed_way})
        for (const Trial& trial : found.ways[way].rows) clock += trial.clock, cpu += trial.cpu;
    const double pace = core::divide_or(clock, cpu, 1.0);
    std::vector<WayCost> costs;
    for (const std::size_t way : {coupled_way, fixed_way, usual_way, strongest_way}) {
        const Difference d = difference_of(found.ways[coupled_way], found.ways[way]);
        if (row >= found.ways[way].rows.size() || (way != coupled_way && !std::isfinite(d.psnr_y))) continue;
        const Trial& trial = found.ways[way].rows[row];
        double frame = trial.cpu;
        // Light of a fixed tolerance was timed with our coding.
        if (way != coupled_way) frame += trial.code_seconds - found.ways[fixed_way].rows[row].code_seconds;
        const double seconds = frame * static_cast<double>(frames);
        costs.push_back({way, way == coupled_way ? 1 : 1 / (1 + d.psnr_y / 100), pace * seconds, seconds});
    }
    std::stable_sort(costs.begin(), costs.end(), [](const WayCost& a, const WayCost& b) { return a.bits < b.bits; });
    return costs;
}

std::optional<std::size_t> recommended(const std::vector<WayCost>& costs) {
    // chosen: bits by a few samples scatter by as much (0.5 to 2 %).
    constexpr double same = 1.01;
    std::vector<Offer> offers;
    for (const WayCost& cost : costs) offers.push_back({cost.cpu, cost.bits <= same * costs.front().bits});
    return cheapest_alike(offers);
}

std::size_t row_of(const Comparison& found, int quantiser) {
    const auto& rows = found.ways[coupled_way].rows;
    const auto away = [&](const Trial& t) { return std::abs(t.quantiser - quantiser); };
    return static_cast<std::size_t>(
        std::min_element(rows.begin(), rows.end(), [&](const Trial& a, const Trial& b) { return away(a) < away(b); }) -
        rows.begin());
}

std::string answer_of(const Comparison& found, std::int64_t frames, int quantiser) {
    if (!found.complete || found.ways[coupled_way].rows.empty()) return {};
    const std::size_t row = row_of(found, quantiser);
    const std::vector<WayCost> costs = way_costs(found, frames, row);
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return {};
    const WayCost& cost = costs[*taken];
    const double bytes = found.ways[cost.way].rows[row].bytes_in_film() * static_cast<double>(frames);
    return fmt::format("Take {}: your film of {} frames takes about {} and has about {} at quantiser {}.",
                       found.ways[cost.way].name, frames, time_text(cost.clock, cost.cpu), size_text(bytes),
                       found.ways[coupled_way].rows[row].quantiser);
}

std::string sentence_of(const Comparison& found) {
    if (!found.complete) return {};
    const Way& coupled = found.ways[coupled_way];
    const Difference usual = difference_of(coupled, found.ways[usual_way]),
                     strongest = difference_of(coupled, found.ways[strongest_way]);
    if (!std::isfinite(usual.psnr_y) || !std::isfinite(strongest.psnr_y))
        return "These films have no quality in common that they could be compared at.";
    std::string text = fmt::format(
        "At equal PSNR-Y the coupled film has {} bits than a fixed 2 % coded by ffmpeg, and {} than by its strongest "
        "command",
        more_text(usual.psnr_y), more_text(strongest.psnr_y));
    if (std::isfinite(usual.seconds) && std::isfinite(strongest.seconds))
        text += fmt::format("; light, motion and coding take {:.2f} and {:.2f} times their time",
                            1 + usual.seconds / 100, 1 + strongest.seconds / 100);
    return text + ".";
}

std::string compare_heading(const RenderJob& film, const Comparison& found) {
    std::int64_t frames = 0;
    for (const Chunk& window : found.windows) frames += window.frames();
    return fmt::format("{}: {} frames of {}x{} in {} window{}; {} by {}\n", film.animation->source, frames,
                       film.format.width, film.format.height, found.windows.size(),
                       found.windows.size() == 1 ? "" : "s", found.references,
                       reference_light(film, found.light_points)) +
           fmt::format("as reference, {} s of CPU each for light\n", short_figure(found.reference_seconds));
}

std::string way_heading() {
    return fmt::format(
        "\nCPU seconds and size per frame; decoded against reference light before coding.\n"
        "{:<23}{:>2} {:>6} {:>6} {:>8} {:>6} {:>7} {:>6} {:>7}\n",
        "", "q", "light", "code", "size", "PSNR-Y", "SSIM", "HVS-M", "flicker");
}

std::string way_row(const std::string& name, const Trial& t) {
    const Quality q = quality_of(t, true);
    return fmt::format("{:<23}{:>2} {:>6} {:>6} {:>8} {:>6} {:>7.4f} {:>6} {:>7.3f}\n", name, t.quantiser,
                       short_figure(t.seconds), short_figure(t.code_seconds), size_text(t.bytes), psnr_text(q.psnr_y),
                       q.ssim_y, psnr_text(q.psnr_hvs_m), t.flicker);
}

std::string difference_table(const Comparison& found) {
    std::string text = "\nBits at equal quality, and time at equal PSNR-Y, against a fixed 2 % coded by\n";
    std::optional<std::size_t> last;
    for (const auto& [way, from] : held_against) {
        if (last != from)
            text += fmt::format("{:<28}{:>10} {:>10} {:>10} {:>10}\n", found.ways[from].name, "PSNR-Y", "SSIM", "HVS-M",
                                "time");
        last = from;
        const Difference d = difference_of(found.ways[way], found.ways[from]);
        text += fmt::format("  {:<26}{:>10} {:>10} {:>10} {:>10}\n", found.ways[way].name, change_text(d.psnr_y),
                            change_text(d.ssim_y), change_text(d.psnr_hvs_m), change_text(d.seconds));
    }
    return text;
}

std::string time_table(const Comparison& found) {
    if (found.runs < 2) return {};
    std::string text = fmt::format(
        "\nTimes: medians of {} runs, and how far these are apart\n{:<23}{:>2} {:>8} {:>6} "
        "{:>8} {:>6}\n",
        found.runs, "", "q", "light", "", "code", "");
    // Times below the clock's resolution have no spread.
    const auto apart = [](double middle, const std::vector<double>& runs) {
        return middle < 0.0005 ? std::string("-") : fmt::format("{:.0f} %", 100 * spread(runs));
    };
    for (const Way& way : found.ways)
        for (std::size_t i = 0; i < way.rows.size(); ++i) {
            const Trial& row = way.rows[i];
            text += fmt::format("{:<23}{:>2} {:>8} {:>6} {:>8} {:>6}\n", way.name, row.quantiser,
                                short_figure(row.seconds), apart(row.seconds, way.times[i].light),
                                short_figure(row.code_seconds), apart(row.code_seconds, way.times[i].code));
        }
    return text;
}

double bits_beside(const Comparison& found) {
    if (!found.foreign || found.ways.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::vector<RatePoint> ours;
    for (const Trial& t : found.ways[coupled_way].rows)
        if (const double psnr = quality_of(t, true).psnr_y; std::isfinite(psnr)) ours.push_back({t.bytes, psnr});
    const RatePoint theirs{found.foreign->bytes, found.foreign->psnr_y};
    if (!std::isfinite(theirs.psnr)) return std::numeric_limits<double>::quiet_NaN();
    // A very short curve, whose rate is constant.
    return 1 + bd_rate({theirs, {theirs.bits, theirs.psnr + 1e-6}}, ours) / 100;
}

std::string foreign_lines(const Comparison& found) {
    if (!found.foreign) return {};
    const ForeignFilm& f = *found.foreign;
    std::string text = fmt::format(
        "\n{}: {} per picture; {} of {} pictures against their reference:\nPSNR-Y {}, SSIM {:.4f}, HVS-M {}\n", f.name,
        size_text(f.bytes), f.compared, f.pictures, psnr_text(f.psnr_y), f.ssim_y, psnr_text(f.psnr_hvs_m));
    const double ratio = bits_beside(found);
    if (std::isfinite(ratio))
        text += fmt::format("at that PSNR-Y the coupled film has {:.2f} times its bytes per picture\n", ratio);
    return text;
}

double median(std::vector<double> seconds) {
    if (seconds.empty()) return 0;
    std::sort(seconds.begin(), seconds.end());
    const std::size_t n = seconds.size();
    return 0.5 * (seconds[(n - 1) / 2] + seconds[n / 2]);
}

double spread(const std::vector<double>& seconds) {
    if (seconds.empty()) return 0;
    const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
    return core::divide_or(*most - *least, median(seconds), 0.0);
}

std::string change_text(double per_cent) {
    return std::isfinite(per_cent) ? fmt::format("{:+.1f} %", per_cent) : "-";
}

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
