#include "app/experiments/tune_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/experiments/film_costs.h"
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

using nlohmann::json;
using Kind = Target::Kind;

Quality quality_of(const Tuning& tuning, const Trial& trial) {
    return quality_of(trial, tuning.against_references());
}

double rate_of(const Trial& trial, double hertz) {
    return 8 * trial.bytes_in_film() * hertz;
}

/// "quality 63.4", or another setting's name.
std::string name_of(const Tuning& tuning, const Probe& probe) {
    return tuning.target.kind == Kind::time ? probe.setting : "quality " + probe.setting;
}

/// "41.97 dB PSNR-Y and 0.9834 SSIM"
std::string quality_text(const Tuning& tuning, const Trial& trial) {
    const Quality quality = quality_of(tuning, trial);
    return fmt::format("{} dB PSNR-Y and {:.4f} SSIM", psnr_text(quality.psnr_y), quality.ssim_y);
}

std::string quality_sentence(const Tuning& tuning, double hertz) {
    const Probe& probe = tuning.probes[*tuning.chosen];
    const std::string asked = target_text(tuning.target), name = name_of(tuning, probe);
    const std::string value = figure_text(tuning.target.kind, probe.value);
    if (tuning.found == Found::beyond)
        return fmt::format("{} is out of reach: {}, the {}, comes to {}.", asked, name,
                           probe.value < tuning.target.value ? "finest" : "coarsest", value);
    if (is_lossless(tuning.target, probe.value) && tuning.found == Found::between && *probe.trial.quality <= 0)
        return fmt::format(
            "Nothing is lost on the sample whatever the quality, where {} was asked for: {}, the "
            "coarsest, is taken; {}, {} s of CPU per frame for light.",
            asked, name, figure_text(Kind::bitrate, rate_of(probe.trial, hertz)), short_figure(probe.trial.seconds));
    std::string text = fmt::format("{}{} comes to {} on the sample, where {} was asked for",
                                   name.substr(0, 1) == "q" ? "Q" : name.substr(0, 1), name.substr(1), value, asked);
    if (tuning.found == Found::between)
        text += ": qualities rise in steps here, and none that was tried comes nearer" +
                std::string(probe.value < tuning.target.value ? "" : " from above");
    return text + fmt::format("; {}, {} s of CPU per frame for light.",
                              figure_text(Kind::bitrate, rate_of(probe.trial, hertz)),
                              short_figure(probe.trial.seconds));
}

std::string rate_sentence(const Tuning& tuning, double hertz) {
    const Probe& probe = tuning.probes[*tuning.chosen];
    const std::string asked = target_text(tuning.target), name = name_of(tuning, probe);
    const std::string rate = figure_text(Kind::bitrate, rate_of(probe.trial, hertz));
    if (tuning.found == Found::beyond)
        return fmt::format("{} is out of reach: even {} needs {} on the sample.", asked, name, rate);
    if (tuning.found == Found::between && *probe.trial.quality >= 100)
        return fmt::format("{} are more than the finest film needs on the sample: {} is {}: {}.", asked, name, rate,
                           quality_text(tuning, probe.trial));
    const std::string text = tuning.target.kind == Kind::size
                                 ? fmt::format("{} leave {} kb/s for pictures, which is ", asked,
                                               std::stol(tuning.options.front().second) / 1000)
                                 : asked + " is ";
    return text + fmt::format("{} on the sample ({}): {}.", name, rate, quality_text(tuning, probe.trial));
}

std::string time_sentence(const Tuning& tuning) {
    const Probe& probe = tuning.probes[*tuning.chosen];
    const std::string asked = clock_text(tuning.target.value), film = clock_text(probe.value);
    if (tuning.found == Found::beyond)
        return fmt::format("{} on the clock is out of reach: {} takes about {}.", asked, probe.setting, film);
    return fmt::format("The film takes about {} of {} on the clock ({}): {} on the sample.", film, asked, probe.setting,
                       quality_text(tuning, probe.trial));
}

json quality_json(const Quality& quality) {
    return app::quality_json(quality.psnr_y, quality.ssim_y);
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
            {"bytes", t.bytes_in_film()},
            {"bit_rate", 8 * t.bytes_in_film() * hertz},
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
            .points.push_back({time ? p.value : 8e-3 * p.trial.bytes_in_film() * hertz, quality.psnr_y,
                               p.lit ? p.setting : "", is_taken(tuning, i)});
    }
    for (Curve* curve : {&lit, &again})
        std::sort(curve->points.begin(), curve->points.end(),
                  [](const CurvePoint& a, const CurvePoint& b) { return a.x < b.x; });
    plot.curves = {lit, again};
    return figure_of(plot);
}

std::string table(const Tuning& tuning, double hertz) {
    const bool time = tuning.target.kind == Kind::time;
    std::vector<TableRow> rows;
    for (std::size_t i = 0; i < tuning.probes.size(); ++i) {
        const Probe& p = tuning.probes[i];
        const Quality quality = quality_of(tuning, p.trial);
        const bool taken = is_taken(tuning, i);
        rows.push_back({{name_of(tuning, p) + (taken ? ", taken" : ""), short_figure(p.trial.seconds),
                         short_figure(p.trial.code_seconds), fmt::format("{:.1f}", 1e-3 * rate_of(p.trial, hertz)),
                         psnr_text(quality.psnr_y), fmt::format("{:.4f}", quality.ssim_y),
                         time ? clock_text(p.value) : "", p.lit ? "its own" : "another probe's"},
                        taken});
    }
    return html_table("What was tried", "tnnnnnnt",
                      {"Setting", "Light, s", "Coding, s", "kb/s", "PSNR-Y", "SSIM", time ? "Film" : "", "Light"},
                      rows) +
           "<p class=\"soft\">CPU seconds per frame. PSNR-Y and SSIM: decoded, against the frames as " +
           (tuning.against_references() ? "lit, with what light adds on those lit as the reference."
                                        : "they were lit.") +
           "</p>\n";
}

/// Clock seconds per CPU second, over all that was lit.
double pace_of(const Tuning& tuning) {
    double clock = 0, cpu = 0;
    for (const Probe& p : tuning.probes)
        if (p.lit) clock += p.trial.clock, cpu += p.trial.cpu;
    return core::divide_or(clock, cpu, 0.0);
}

std::string time_to_make(const RenderJob& film, const Tuning& tuning) {
    if (!tuning.chosen) return {};
    const double frame = pace_of(tuning) * tuning.probes[*tuning.chosen].trial.cpu;
    return fmt::format(" Your film of {} frames takes about {}.", film.frame_count(),
                       clock_text(frame * static_cast<double>(film.frame_count())));
}

std::string first_screen(const RenderJob& film, const Tuning& tuning) {
    const auto frames = static_cast<double>(film.frame_count());
    const double pace = pace_of(tuning);
    double longest = 0;
    for (const Probe& p : tuning.probes)
        if (p.lit) longest = std::max(longest, pace * p.trial.cpu);
    std::vector<AnswerRow> rows;
    for (std::size_t i = 0; i < tuning.probes.size(); ++i) {
        const Probe& p = tuning.probes[i];
        if (!p.lit && tuning.chosen != i) continue;
        const Quality quality = quality_of(tuning, p.trial);
        const double clock = pace * p.trial.cpu;
        rows.push_back({name_of(tuning, p), core::divide_or(clock, longest, 0.0), clock_text(clock * frames),
                        psnr_text(quality.psnr_y) + " dB", is_taken(tuning, i) ? Grade::good : Grade::none,
                        fmt::format("SSIM {:.4f}", quality.ssim_y), size_text(p.trial.bytes_in_film() * frames),
                        is_taken(tuning, i)});
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const AnswerRow& a, const AnswerRow& b) { return a.share < b.share; });
    std::string figure;
    if (tuning.chosen)
        if (const auto& own = tuning.probes[*tuning.chosen].trial.sample_frame)
            figure = difference_figure(fmt::format("Frame {}: decoded, beside exact light", own->frame),
                                       {"decoded", own->decoded}, {"exact, not coded", own->truth},
                                       perceptual::matrix_for(film.format.height));
    return answer_screen(answer_table({"setting", "time, whole film", "PSNR-Y", "film"}, rows,
                                      "Times are of this machine, as busy as it was; all figures from the sample."),
                         figure, tuning.command.value_or(""));
}

}  // namespace

std::string tune_heading(const RenderJob& film, const Tuning& tuning) {
    std::int64_t frames = 0;
    for (const Chunk& window : tuning.windows) frames += window.frames();
    std::string text = fmt::format("{}: {} of {} frames of {}x{} in {} window{}\n", film.animation->source, frames,
                                   film.frame_count(), film.format.width, film.format.height, tuning.windows.size(),
                                   tuning.windows.size() == 1 ? "" : "s");
    text +=
        tuning.against_references()
            ? fmt::format("quality by {} frame{} lit as the reference, {} s of CPU each for light\n", tuning.references,
                          tuning.references == 1 ? "" : "s", short_figure(tuning.reference_seconds))
            : "quality against these frames as they were lit\n";
    text += "CPU seconds per frame for light" + std::string(tuning.target.kind == Kind::time ? "" : " and for coding");
    return text +
           (tuning.target.kind == Kind::time
                ? fmt::format("; the whole film's time on the clock\n\n{:>8} {:>10} {:>7} {:>7} {:>9}  setting\n",
                              "light", "kb/s", "PSNR-Y", "SSIM", "film")
                : fmt::format("\n\n{:>8} {:>8} {:>8} {:>10} {:>7} {:>7}\n", "quality", "light", "coding", "kb/s",
                              "PSNR-Y", "SSIM"));
}

std::string probe_row(const Tuning& tuning, const Probe& probe, double pictures_per_second) {
    const Trial& t = probe.trial;
    const Quality quality = quality_of(tuning, t);
    const double rate = 1e-3 * rate_of(t, pictures_per_second);
    const std::string kilobits = fmt::format("{:.{}f}", rate, rate < 100 ? 1 : 0);
    if (tuning.target.kind == Kind::time)
        return fmt::format("{:>8} {:>10} {:>7} {:>7.4f} {:>9}  {}\n", short_figure(t.seconds), kilobits,
                           psnr_text(quality.psnr_y), quality.ssim_y, clock_text(probe.value), probe.setting);
    return fmt::format("{:>8} {:>8} {:>8} {:>10} {:>7} {:>7.4f}{}\n", probe.setting,
                       probe.lit ? short_figure(t.seconds) : "", short_figure(t.code_seconds), kilobits,
                       psnr_text(quality.psnr_y), quality.ssim_y, probe.lit ? "" : "  the same light");
}

std::string sentence_of(const Tuning& tuning, double pictures_per_second) {
    if (tuning.found == Found::stopped || !tuning.chosen) return {};
    if (tuning.target.is_quality()) return quality_sentence(tuning, pictures_per_second);
    return tuning.target.is_rate() ? rate_sentence(tuning, pictures_per_second) : time_sentence(tuning);
}

std::string film_sentence(const Tuning& tuning) {
    if (!tuning.film) return {};
    const WholeFilm& film = *tuning.film;
    const Target& target = tuning.target;
    const Probe& sample = tuning.probes[*tuning.chosen];
    const std::string verdict = film_is_near(tuning) ? "The film has" : "The film missed it: it has";
    std::string text = fmt::format("{} {} where {} was asked for", verdict,
                                   figure_text(target.kind, film_value(tuning)), target_text(target));
    if (target.kind != Kind::size)
        text += fmt::format(" and the sample had {}", figure_text(target.kind, sample.value));
    text += fmt::format(". {} ({}); decoded against its frames as lit {} dB PSNR-Y and {:.4f} SSIM",
                        figure_text(Kind::bitrate, film.bit_rate), size_text(film.bytes), psnr_text(film.psnr_y),
                        film.ssim_y);
    if (film.references > 0)
        text += fmt::format(", against reference light {} and {:.4f}", psnr_text(film.reference.psnr_y),
                            film.reference.ssim_y);
    text += fmt::format("; it took {} on the clock.", clock_text(film.seconds));
    if (const auto quality = nearer_quality(tuning)) text += fmt::format(" --quality {:.1f} comes nearer.", *quality);
    return text;
}

bool is_taken(const Tuning& tuning, std::size_t probe) {
    return tuning.chosen == probe && tuning.found != Found::beyond && film_is_near(tuning);
}

std::optional<double> nearer_quality(const Tuning& tuning) {
    const Target& target = tuning.target;
    if (!target.is_quality() || film_is_near(tuning)) return {};
    const double step =
        (even_figure(target, target.value) - even_figure(target, film_value(tuning))) / even_slope(target);
    return std::clamp(*tuning.probes[*tuning.chosen].trial.quality + step, 0.0, 100.0);
}

double film_value(const Tuning& tuning) {
    const WholeFilm& film = *tuning.film;
    const Quality as_lit{film.psnr_y, film.ssim_y, 0}, &quality = film.references > 0 ? film.reference : as_lit;
    switch (tuning.target.kind) {
        case Kind::psnr:
            return quality.psnr_y;
        case Kind::ssim:
            return quality.ssim_y;
        case Kind::bitrate:
            return film.bit_rate;
        case Kind::size:
            return film.bytes;
        case Kind::time:
            return film.seconds;
    }
    return 0;
}

bool film_is_near(const Tuning& tuning) {
    if (!tuning.film) return true;
    const Target& target = tuning.target;
    const double value = film_value(tuning);
    // chosen: films differ from their samples by up to a third of a decibel (three times what the search leaves).
    constexpr double sampled = 3;
    if (target.kind == Kind::size || target.kind == Kind::time) return value <= target.value;
    // A better result is no miss where settings are steps, or where the finest film falls short.
    const bool finest =
        tuning.found == Found::between && !tuning.options.empty() && tuning.options.front().first == "--quality";
    if (target.kind == Kind::bitrate) return is_near(target, value) || (finest && value <= target.value);
    // chosen: a step of quality is less than a decibel.
    return is_near(target, value, sampled) || (finest && value >= target.value && is_near(target, value, 3 * sampled));
}

json tune_json(const RenderJob& film, const Tuning& tuning, const std::string& command) {
    const double hertz = film.rate.hertz.value();
    json probes = json::array(), options = json::object();
    for (const Probe& probe : tuning.probes) probes.push_back(probe_json(probe, hertz, tuning.against_references()));
    for (const auto& [name, value] : tuning.options) options[name.substr(2)] = value;
    constexpr const char* outcomes[] = {"near", "between", "beyond", "stopped"};
    json all = trial_json(film, command, tuning.windows, tuning.references, tuning.reference_seconds);
    all.update({{"exposure", film.exposure.value_or(0)},
                {"view", core::text_of(film.view)},
                {"target", target_json(tuning.target)},
                {"probes", probes},
                {"found", outcomes[static_cast<int>(tuning.found)]},
                {"chosen", tuning.chosen ? json(*tuning.chosen) : json(nullptr)},
                {"options", options},
                {"render", tuning.command ? json(*tuning.command) : json(nullptr)},
                {"film", tuning.film ? film_json(*tuning.film, film_is_near(tuning)) : json(nullptr)},
                {"summary", sentence_of(tuning, hertz)}});
    return all;
}

void write_tune_report(const std::filesystem::path& html, const RenderJob& film, const Tuning& tuning,
                       const std::string& command) {
    const double hertz = film.rate.hertz.value();
    std::string body;
    if (const std::string text = film_sentence(tuning); !text.empty()) body += "<p>" + escaped(text) + "</p>\n";
    body += first_screen(film, tuning);
    std::string all = plot(tuning, hertz);
    if (tuning.chosen) {
        const Probe& taken = tuning.probes[*tuning.chosen];
        all += sample_frame_figures(name_of(tuning, taken), taken.trial, film);
    }
    body += folded("All curves and tables", all + table(tuning, hertz));
    write_trial_page(html, film, "tuned to " + target_text(tuning.target),
                     sentence_of(tuning, hertz) + time_to_make(film, tuning), body, command, "docs/json.md",
                     tune_json(film, tuning, command));
}

}  // namespace render2mpeg::app
