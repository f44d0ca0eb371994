#include "app/experiments/tune_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/experiments/sample_frame_view.h"
#include "app/experiments/sweep.h"
#include "app/experiments/tune_table.h"
#include "app/files/text_file.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/frame_plot.h"
#include "app/report/report.h"
#include "app/report/statistics_json.h"
#include "app/system/progress.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;
using Kind = Target::Kind;

json quality_json(const Quality& quality) {
    return {{"psnr_y", finite_or_null(quality.psnr_y)}, {"ssim_y", quality.ssim_y}};
}

json target_json(const Target& target) {
    constexpr const char* names[] = {"psnr_y", "ssim_y", "bitrate", "size", "time"};
    return {{"what", names[static_cast<int>(target.kind)]}, {"value", target.value}};
}

json probe_json(const Probe& probe, double hertz, bool referenced) {
    const Trial& t = probe.trial;
    return {{"setting", probe.setting},
            {"quality", t.quality ? json(*t.quality) : json(nullptr)},
            {"lit", probe.lit},
            {"value", finite_or_null(probe.value)},
            {"light_seconds", t.seconds},
            {"code_seconds", t.code_seconds},
            {"clock", t.clock},
            {"bytes", t.bytes},
            {"bit_rate", 8 * t.bytes * hertz},
            {"as_lit", quality_json(quality_of(t, false))},
            {"referenced", referenced ? quality_json(quality_of(t, true)) : json(nullptr)}};
}

json film_json(const WholeFilm& film, bool near) {
    return {{"frames", film.frames},
            {"bytes", film.bytes},
            {"bit_rate", film.bit_rate},
            {"seconds", film.seconds},
            {"as_lit", quality_json({film.psnr_y, film.ssim_y})},
            {"references", film.references},
            {"referenced", film.references > 0 ? quality_json(film.reference) : json(nullptr)},
            {"near", near}};
}

std::string plot(const Tuning& tuning, double hertz) {
    const bool time = tuning.target.kind == Kind::time;
    CurvePlot plot{"Quality of what was tried",
                   {time ? "seconds on the clock for the film" : "kb/s", true},
                   {"PSNR-Y, dB", false},
                   {}};
    Curve lit{"lit for it", "i", {}}, again{"light of another probe", "one", {}};
    for (std::size_t i = 0; i < tuning.probes.size(); ++i) {
        const Probe& p = tuning.probes[i];
        const Quality quality = quality_of(p.trial, tuning.against_references());
        (p.lit ? lit : again)
            .points.push_back({time ? p.value : 8e-3 * p.trial.bytes * hertz, quality.psnr_y, p.lit ? p.setting : "",
                               tuning.chosen == i});
    }
    for (Curve* curve : {&lit, &again})
        std::sort(curve->points.begin(), curve->points.end(),
                  [](const CurvePoint& a, const CurvePoint& b) { return a.x < b.x; });
    plot.curves = {lit, again};
    return figure_of(plot);
}

std::string table(const Tuning& tuning, double hertz) {
    const bool time = tuning.target.kind == Kind::time;
    std::string text = "<h2>What was tried</h2>\n<div class=\"wide\"><table>\n<tr><th>Setting</th>";
    for (const char* head : {"Light, s", "Coding, s", "kb/s", "PSNR-Y", "SSIM", time ? "Film" : ""})
        if (*head != '\0') text += fmt::format("<th class=\"n\">{}</th>", head);
    text += "<th>Light</th></tr>\n";
    for (std::size_t i = 0; i < tuning.probes.size(); ++i) {
        const Probe& p = tuning.probes[i];
        const Quality quality = quality_of(p.trial, tuning.against_references());
        const std::string name = (time ? "" : "quality ") + p.setting;
        text += "<tr><td>" + (tuning.chosen == i ? "<b>" + escaped(name) + ", taken</b>" : escaped(name)) + "</td>";
        std::vector<std::string> cells{short_figure(p.trial.seconds), short_figure(p.trial.code_seconds),
                                       fmt::format("{:.1f}", 8e-3 * p.trial.bytes * hertz),
                                       std::isfinite(quality.psnr_y) ? fmt::format("{:.2f}", quality.psnr_y) : "same",
                                       fmt::format("{:.4f}", quality.ssim_y)};
        if (time) cells.push_back(clock_text(p.value));
        for (const std::string& cell : cells) text += "<td class=\"n\">" + cell + "</td>";
        text += p.lit ? "<td>its own</td></tr>\n" : "<td>another probe's</td></tr>\n";
    }
    return text + "</table></div>\n<p class=\"soft\">CPU seconds per frame. " +
           (tuning.against_references() ? "PSNR-Y and SSIM: decoded, against the frames as lit, with what light adds "
                                          "on those lit by every light point."
                                        : "PSNR-Y and SSIM: decoded, against the frames as they were lit.") +
           "</p>\n";
}

}  // namespace

json tune_json(const RenderJob& film, const Tuning& tuning, const std::string& command) {
    const double hertz = film.rate.hertz.value();
    json windows = json::array(), probes = json::array(), options = json::object();
    for (const Chunk& window : tuning.windows) windows.push_back({window.first, window.last});
    for (const Probe& probe : tuning.probes) probes.push_back(probe_json(probe, hertz, tuning.against_references()));
    for (const auto& [name, value] : tuning.options) options[name.substr(2)] = value;
    constexpr const char* outcomes[] = {"near", "between", "beyond", "stopped"};
    return {{"command", command},
            {"version", RENDER2MPEG_VERSION},
            {"isa", core::name_of(film.rendering.isa)},
            {"input", film.animation->source},
            {"width", film.format.width},
            {"height", film.format.height},
            {"fps", hertz},
            {"exposure", film.exposure.value_or(0)},
            {"target", target_json(tuning.target)},
            {"windows", windows},
            {"reference", {{"frames", tuning.references}, {"seconds", tuning.reference_seconds}}},
            {"probes", probes},
            {"found", outcomes[static_cast<int>(tuning.found)]},
            {"chosen", tuning.chosen ? json(*tuning.chosen) : json(nullptr)},
            {"options", options},
            {"render", tuning.command ? json(*tuning.command) : json(nullptr)},
            {"film", tuning.film ? film_json(*tuning.film, film_is_near(tuning)) : json(nullptr)},
            {"summary", sentence_of(tuning, hertz)}};
}

void write_tune_report(const std::filesystem::path& html, const RenderJob& film, const Tuning& tuning,
                       const std::string& command) {
    const double hertz = film.rate.hertz.value();
    const std::filesystem::path source = film.animation->source;
    const std::string name = (source.has_filename() ? source : source.parent_path()).filename().string();
    std::string body;
    if (const std::string text = film_sentence(tuning, hertz); !text.empty()) body += "<p>" + escaped(text) + "</p>\n";
    body += plot(tuning, hertz);
    if (tuning.chosen) {
        const Probe& taken = tuning.probes[*tuning.chosen];
        body += sample_frame_figures((tuning.target.kind == Kind::time ? "" : "quality ") + taken.setting, taken.trial,
                                     perceptual::matrix_for(film.format.height));
    }
    body += table(tuning, hertz);
    if (tuning.command) body += "<h2>To make the film</h2>\n<pre>" + escaped(*tuning.command) + "</pre>\n";
    body += "<h2>To find it out again</h2>\n<pre>" + escaped(command) +
            "</pre>\n<p class=\"soft\">Every figure is in the JSON file beside this page (docs/tune.md).</p>\n";
    write_whole(html,
                report_page("Tuned to " + target_text(tuning.target) + ": " + name, sentence_of(tuning, hertz), body));
    write_json(report_json_of(html), tune_json(film, tuning, command));
}

}  // namespace render2mpeg::app
