#include "app/experiments/tune_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/system/progress.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;
using Kind = Target::Kind;

const TrialColumns by_quality{&columns::light, &columns::code, &columns::kilobits, &columns::psnr_y, &columns::ssim_y},
    by_time{&columns::light, &columns::kilobits, &columns::psnr_y, &columns::ssim_y};

/// "quality 63.4", or another setting's name.
std::string name_of(const Target& target, const Probe& probe) {
    return target.kind == Kind::time ? probe.setting : "quality " + probe.setting;
}

/// Why a setting that is taken misses the target; empty where it meets it.
std::string cause_of(const Tuning& tuning, const Probe& probe) {
    if (tuning.found != Found::between) return {};
    if (is_lossless(tuning.target, probe.value) && *probe.trial.quality <= 0)
        return ": nothing is lost on the sample whatever the quality";
    if (tuning.target.is_rate() && *probe.trial.quality >= 100) return ": the finest film needs no more";
    return tuning.target.is_quality() ? ": qualities rise in steps here, and none that was tried comes nearer" : "";
}

json quality_json(const Quality& quality) {
    return {{"psnr_y", finite_or_null(quality.psnr_y)}, {"ssim_y", quality.ssim_y}};
}

json target_json(const Target& target) {
    constexpr const char* names[] = {"psnr_y", "ssim_y", "bitrate", "size", "time"};
    return {{"what", names[static_cast<int>(target.kind)]}, {"value", target.value}};
}

json film_json(const Tuning& tuning) {
    if (!tuning.film) return nullptr;
    const WholeFilm& film = *tuning.film;
    return {{"frames", film.frames},
            {"bytes", film.bytes},
            {"bit_rate", film.bit_rate},
            {"seconds", film.seconds},
            {"as_lit", quality_json({film.psnr_y, film.ssim_y, 0})},
            {"referenced", quality_json(film.reference)},
            {"near", film_is_near(tuning)}};
}

}  // namespace

std::string probe_heads(const Target& target) {
    if (target.kind == Kind::time) {
        std::string heads = heads_text(by_time, fmt::format("{:>9}", "film"), 9);
        heads.insert(heads.size() - 1, "  setting");
        return "CPU seconds per frame for light; the whole film's time on the clock\n\n" + heads;
    }
    return "CPU seconds per frame for light and for coding\n\n" +
           heads_text(by_quality, fmt::format("{:>9}", "quality"), 9);
}

std::string probe_row(const Target& target, const Probe& probe) {
    const bool time = target.kind == Kind::time;
    std::string row = row_text(time ? by_time : by_quality,
                               fmt::format("{:>9}", time ? clock_text(probe.value) : probe.setting), 9, probe.trial);
    row.insert(row.find('\n'), time ? "  " + probe.setting : probe.lit ? "" : "  the same light");
    return row;
}

std::string sentence_of(const Tuning& tuning) {
    if (tuning.found == Found::stopped || !tuning.chosen) return {};
    const Target& target = tuning.target;
    const Probe& probe = tuning.probes[*tuning.chosen];
    std::string name = target.kind == Kind::time ? "with " + probe.setting : name_of(target, probe);
    const std::string value = figure_text(target.is_rate() ? Kind::bitrate : target.kind, probe.value);
    std::string asked = target_text(target);
    if (target.kind == Kind::size && !tuning.options.empty())
        asked += fmt::format(" ({} of pictures)", figure_text(Kind::bitrate, std::stod(tuning.options.front().second)));
    if (tuning.found == Found::beyond)
        return fmt::format("{} is out of reach: {} the sample comes to {}.", asked,
                           target.kind == Kind::time ? name : "with " + name, value);
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    const Quality quality = probe.trial.film_quality();
    return fmt::format(
        "{} {} comes to {}, where {} was asked for{}; {}, {} dB PSNR-Y and {:.4f} SSIM, {} s of CPU per frame for "
        "light.",
        name, target.kind == Kind::time ? "the film" : "on the sample", value, asked, cause_of(tuning, probe),
        figure_text(Kind::bitrate, probe.trial.bit_rate), psnr_text(quality.psnr_y), quality.ssim_y,
        short_figure(probe.trial.seconds));
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
    if (sample.trial.has_references)
        text += fmt::format(", with what light adds {} and {:.4f}", psnr_text(film.reference.psnr_y),
                            film.reference.ssim_y);
    text += fmt::format("; it took {} on the clock.", clock_text(film.seconds));
    if (const auto quality = nearer_quality(tuning)) text += fmt::format(" --quality {:.1f} comes nearer.", *quality);
    return text;
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
    switch (tuning.target.kind) {
        case Kind::psnr:
            return film.reference.psnr_y;
        case Kind::ssim:
            return film.reference.ssim_y;
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

json tune_json(const Tuning& tuning) {
    json rows = json::array(), options = json::object();
    for (const Probe& probe : tuning.probes) {
        rows.push_back(figures_json(probe.trial));
        rows.back().update({{"setting", probe.setting}, {"lit", probe.lit}, {"value", finite_or_null(probe.value)}});
    }
    for (const auto& [name, value] : tuning.options) options[name.substr(2)] = value;
    constexpr const char* outcomes[] = {"near", "between", "beyond", "stopped"};
    return {{"target", target_json(tuning.target)},
            {"rows", rows},
            {"found", outcomes[static_cast<int>(tuning.found)]},
            {"chosen", tuning.chosen ? json(*tuning.chosen) : json(nullptr)},
            {"options", options},
            {"render", tuning.command ? json(*tuning.command) : json(nullptr)},
            {"film", film_json(tuning)},
            {"summary", sentence_of(tuning)}};
}

json tune_page(const RenderJob& film, const Tuning& tuning) {
    json page{{"film", film_sentence(tuning)}, {"frame_count", film.frame_count()}, {"pictures", json::array()}};
    if (!tuning.chosen) return page;
    const Probe& taken = tuning.probes[*tuning.chosen];
    page["sample"] = sample_frame_figures(name_of(tuning.target, taken), taken.trial, film);
    if (const auto& own = taken.trial.sample_frame)
        page["pictures"].push_back(pair_of(fmt::format("Frame {}: decoded, beside exact light", own->frame),
                                           {"decoded", own->decoded}, {"exact, not coded", own->reference},
                                           perceptual::matrix_for(film.format.height), true));
    return page;
}

}  // namespace render2mpeg::app
