#include "app/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/curve_plot.h"
#include "app/frame_plot.h"
#include "app/report.h"
#include "app/statistics_json.h"
#include "app/sweep.h"
#include "app/text_file.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// JSON has neither infinity nor what is no number.
json finite_or_null(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

json row_json(const Trial& t) {
    return {{"quantiser", t.quantiser},
            {"light_seconds", t.seconds},
            {"light_window_seconds", t.window_seconds},
            {"requantised", t.requantised},
            {"code_seconds", t.code_seconds},
            {"bytes", t.bytes},
            {"psnr_y", finite_or_null(t.decoded.psnr_y())},
            {"ssim_y", t.decoded.ssim_y()},
            {"psnr_hvs_m", finite_or_null(t.psnr_hvs_m())}};
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
    for (const std::size_t from : {usual_way, strongest_way})
        for (const std::size_t way : {coupled_way, fixed_way})
            all.push_back(difference_json(found.ways[way], found.ways[from]));
    return all;
}

template <class X>
std::string plot(const Comparison& found, const std::string& title, const std::string& axis, X&& x) {
    constexpr const char* colors[] = {"i", "one", "two", "b"};
    CurvePlot plot{title, {axis, true}, {"PSNR-Y, dB", false}, {}};
    for (std::size_t i = 0; i < found.ways.size(); ++i) {
        Curve curve{found.ways[i].name, colors[i], {}};
        for (const Trial& t : found.ways[i].rows)
            curve.points.push_back(
                {x(t), t.decoded.psnr_y(), i == coupled_way ? fmt::format("q {}", t.quantiser) : "", false});
        plot.curves.push_back(std::move(curve));
    }
    return figure_of(plot);
}

std::string tables(const Comparison& found) {
    std::string text = "<h2>All figures</h2>\n<div class=\"wide\"><table>\n<tr><th>Way</th>";
    for (const char* head : {"Quantiser", "Light, s", "Coding, s", "Bytes", "PSNR-Y", "SSIM", "HVS-M"})
        text += fmt::format("<th class=\"n\">{}</th>", head);
    text += "</tr>\n";
    const auto decibels = [](double v) { return std::isfinite(v) ? fmt::format("{:.2f}", v) : std::string("same"); };
    for (const Way& way : found.ways)
        for (const Trial& t : way.rows) {
            text += "<tr><td>" + escaped(way.name) + "</td>";
            for (const std::string& cell :
                 {fmt::format("{}", t.quantiser), short_figure(t.seconds), short_figure(t.code_seconds),
                  fmt::format("{:.0f}", t.bytes), decibels(t.decoded.psnr_y()),
                  fmt::format("{:.4f}", t.decoded.ssim_y()), decibels(t.psnr_hvs_m())})
                text += "<td class=\"n\">" + cell + "</td>";
            text += "</tr>\n";
        }
    text += "</table></div>\n";
    if (!found.complete) return text;
    text += "<h2>At equal quality</h2>\n<div class=\"wide\"><table>\n<tr><th>Way</th><th>against</th>";
    for (const char* head : {"Bits, PSNR-Y", "Bits, SSIM", "Bits, HVS-M", "Time, PSNR-Y"})
        text += fmt::format("<th class=\"n\">{}</th>", head);
    text += "</tr>\n";
    for (const std::size_t from : {usual_way, strongest_way})
        for (const std::size_t way : {coupled_way, fixed_way}) {
            const Difference d = difference_of(found.ways[way], found.ways[from]);
            text += "<tr><td>" + escaped(found.ways[way].name) + "</td><td>" + escaped(found.ways[from].name) + "</td>";
            for (const double value : {d.psnr_y, d.ssim_y, d.psnr_hvs_m, d.seconds})
                text += "<td class=\"n\">" + change_text(value) + "</td>";
            text += "</tr>\n";
        }
    return text + "</table></div>\n";
}

std::string commands(const Comparison& found) {
    std::string text = "<h2>The ways</h2>\n<div class=\"wide\"><table>\n";
    for (const Way& way : found.ways)
        text += "<tr><td>" + escaped(way.name) + "</td><td>" + escaped(way.how) + "</td></tr>\n";
    return text + "<tr><td>version</td><td>" + escaped(found.ffmpeg) + "</td></tr>\n</table></div>\n";
}

}  // namespace

json compare_json(const Production& film, const Comparison& found, const std::string& command) {
    json windows = json::array(), ways = json::array();
    for (const Chunk& window : found.windows) windows.push_back({window.first, window.last});
    for (const Way& way : found.ways) {
        json rows = json::array();
        for (const Trial& trial : way.rows) rows.push_back(row_json(trial));
        ways.push_back({{"name", way.name}, {"how", way.how}, {"rows", rows}});
    }
    return {{"command", command},
            {"version", RENDER2MPEG_VERSION},
            {"isa", core::name_of(film.rendering.isa)},
            {"ffmpeg", found.ffmpeg},
            {"input", film.animation->source},
            {"width", film.format.width},
            {"height", film.format.height},
            {"fps", film.rate.hertz.value()},
            {"gop", film.coding.gop},
            {"samples", film.rendering.samples},
            {"vpls", film.rendering.vpls},
            {"masking", film.coupling.observer.strategy == perceptual::Strategy::quantised ? "quantised" : "carried"},
            {"cache", film.rendering.cache ? "on" : "off"},
            {"light_points", found.light_points},
            {"windows", windows},
            {"reference", {{"frames", found.references}, {"seconds", found.reference_seconds}}},
            {"ways", ways},
            {"differences", differences_json(found)},
            {"summary", sentence_of(found)},
            {"complete", found.complete}};
}

void write_compare_report(const std::filesystem::path& html, const Production& film, const Comparison& found,
                          const std::string& command) {
    const std::filesystem::path source = film.animation->source;
    const std::string name = (source.has_filename() ? source : source.parent_path()).filename().string();
    std::string body = "<h2>Curves</h2>\n";
    body += plot(found, "Quality over size", "bytes per frame", [](const Trial& t) { return t.bytes; });
    body += plot(found, "Quality over time for light, motion and coding", "CPU seconds per frame",
                 [](const Trial& t) { return t.seconds + t.code_seconds; });
    body +=
        tables(found) +
        "<p class=\"soft\">Light: CPU seconds of all threads per frame; coding: with exact motion, or with ffmpeg's "
        "search for it on one thread. PSNR-Y, SSIM and PSNR-HVS-M (HVS-M): decoded pictures against pictures lit by "
        "every light point and not coded. At equal quality: mean differences over the qualities that both reach "
        "(Bjontegaard).</p>\n" +
        commands(found) + "<h2>To find it out again</h2>\n<pre>" + escaped(command) +
        "</pre>\n<p class=\"soft\">Every figure is in the JSON file beside this page (docs/compare.md).</p>\n";
    const std::string lead = found.complete ? sentence_of(found) : "Interrupted: this is a part of it.";
    write_whole(html, report_page("Coupled, and rendered first: " + name, lead, body));
    write_json(report_json_of(html), compare_json(film, found, command));
}

}  // namespace render2mpeg::app
