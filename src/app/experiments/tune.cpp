#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/experiments/trial_command.h"
#include "app/experiments/tuning.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/report/frame_view.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "encoder/av/coders.h"
#include "encoder/av/file_size.h"
#include "encoder/capabilities.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;
using Kind = Target::Kind;

const TrialColumns by_quality{"light_seconds", "code_seconds", "kilobits", "psnr_y", "ssim_y"},
    by_time{"light_seconds", "kilobits", "psnr_y", "ssim_y"};

/// "63.4", or the name of less light.
const std::string& setting_of(const Target& target, const Probe& probe) {
    return target.kind == Kind::time ? probe.name : probe.choices.front().second;
}

/// Why a setting that is taken misses the target; empty where it meets it.
std::string cause_of(const Tuning& tuning, const Probe& probe) {
    if (tuning.found != Found::between) return {};
    if (is_lossless(tuning.target, probe.value) && *probe.trial.quality <= 0)
        return ": nothing is lost on the sample whatever the quality";
    if (tuning.target.is_rate() && *probe.trial.quality >= 100) return ": the finest film needs no more";
    return tuning.target.is_quality() ? ": qualities rise in steps here, and none that was tried comes nearer" : "";
}

/// The film's value in the target's unit.
double film_value(const Tuning& tuning) {
    const WholeFilm& film = *tuning.film;
    const double values[] = {film.reference.psnr_y, film.reference.ssim_y, film.bit_rate, film.bytes, film.seconds};
    return values[static_cast<int>(tuning.target.kind)];
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

/// The --quality that comes nearer where a film missed a quality; else none.
std::optional<double> nearer_quality(const Tuning& tuning) {
    const Target& target = tuning.target;
    if (!target.is_quality() || film_is_near(tuning)) return {};
    const double step =
        (even_figure(target, target.value) - even_figure(target, film_value(tuning))) / even_slope(target);
    const double quality = std::clamp(tuning.film->setting + step, 0.0, 100.0);
    // As it is written, it would be the same film's.
    if (std::abs(quality - tuning.film->setting) < 0.05) return {};
    return quality;
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

/// Lines of at most 80 columns, each with its end.
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
    std::string row =
        row_text(time ? by_time : by_quality,
                 fmt::format("{:>9}", time ? clock_text(probe.value) : setting_of(target, probe)), 9, probe.trial);
    row.insert(row.find('\n'), time ? "  " + probe.name : probe.lit ? "" : "  the same light");
    return row;
}

/// The result in a sentence or two; empty after an interruption.
std::string sentence_of(const Tuning& tuning) {
    if (tuning.found == Found::stopped || !tuning.chosen) return {};
    const Target& target = tuning.target;
    const Probe& probe = tuning.probes[*tuning.chosen];
    std::string name = (target.kind == Kind::time ? "with " : "") + probe.name;
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

/// The whole film beside its sample; empty where none was made.
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

/// All results (docs/json.md), and what a page shows besides.
json tune_json(const Tuning& tuning) {
    json rows = json::array(), options = json::object();
    for (const Probe& probe : tuning.probes) {
        rows.push_back(figures_json(probe.trial));
        rows.back().update({{"setting", setting_of(tuning.target, probe)},
                            {"lit", probe.lit},
                            {"value", finite_or_null(probe.value)}});
    }
    for (const auto& [name, value] : tuning.options) options[name.substr(2)] = value;
    constexpr const char* outcomes[] = {"near", "between", "beyond", "stopped"};
    return {{"target", target_json(tuning.target)},
            {"rows", rows},
            {"found", outcomes[static_cast<int>(tuning.found)]},
            {"chosen", or_null(tuning.chosen)},
            {"options", options},
            {"render", text_or_null(line_of(tuning.command))},
            {"film", film_json(tuning)},
            {"summary", sentence_of(tuning)}};
}

json tune_page(const RenderJob& film, const Tuning& tuning) {
    json page{{"film", film_sentence(tuning)}, {"frame_count", film.frame_count()}, {"pictures", json::array()}};
    if (!tuning.chosen) return page;
    const Probe& taken = tuning.probes[*tuning.chosen];
    page["sample"] = sample_frame_figures(taken.name, taken.trial, film);
    if (const auto& own = taken.trial.sample_frame)
        page["pictures"].push_back(pair_of(fmt::format("Frame {}: decoded, beside exact light", own->frame),
                                           {"decoded", own->decoded}, {"exact, not coded", own->reference},
                                           film.colors(), true));
    return page;
}

Target target_of(const TrialOptions& o) {
    std::vector<Target> asked;
    const bool worst = o.of == "worst-tenth";
    if (o.psnr) asked.push_back({Kind::psnr, *o.psnr, worst});
    if (o.ssim) asked.push_back({Kind::ssim, *o.ssim, worst});
    if (o.bitrate) asked.push_back({Kind::bitrate, static_cast<double>(*o.bitrate)});
    if (o.size) asked.push_back({Kind::size, *o.size});
    if (o.time) asked.push_back({Kind::time, *o.time});
    if (asked.size() != 1)
        throw UsageError(
            "tune: what is to be reached? Give one of --target-psnr, --target-ssim, --target-bitrate, --max-size and "
            "--max-time");
    return asked.front();
}

/// Refuses contradictions to the target.
void check_options(const TrialOptions& o, const Target& target) {
    const CodingOptions& coding = o.render.coding;
    if (target.kind != Kind::time && (coding.quality || coding.quantiser || coding.crf))
        throw UsageError(std::string(coding.quality     ? "--quality"
                                     : coding.quantiser ? "--quantiser"
                                                        : "--crf") +
                         ": it is what is looked for; it goes with --max-time only");
    if (o.render.output.empty() && !o.render.dry_run)
        throw UsageError("tune: which film is to be made? Give -o film.mpg, or --dry-run");
    if (!o.render.output.empty() && kind_of(o.render.output) != OutputKind::film)
        throw UsageError("tune: " + o.render.output.string() + " is not coded, and so has nothing to tune");
}

/// Target of the trials: a file size becomes a bit rate.
Target searched(const Target& target, const RenderJob& film, const std::filesystem::path& output) {
    if (target.kind != Kind::size) return target;
    const double seconds = static_cast<double>(film.frame_count()) / film.rate.hertz.value();
    return {Kind::bitrate, av::pictures_in_file(target.value, film.frame_count(), output, film.disc) * 8 / seconds};
}

/// Refuses rates that `render` would refuse, before anything is lit.
void check_rate(const Target& target, const RenderJob& film) {
    if (target.kind != Kind::bitrate || film.coding.rate_control.max_rate == 0) return;
    encoder::Settings coding = film.coding;
    coding.rate_control.mode = encoder::RateMode::variable;
    coding.rate_control.bit_rate = std::llround(target.value);
    av::check(coding);
}

/// Highest rate of the film's level; infinite for other codecs.
double highest_rate(const RenderJob& film) {
    if (film.coding.codec != encoder::Codec::mpeg2) return std::numeric_limits<double>::infinity();
    const std::int64_t wanted = film.coding.rate_control.max_rate;
    return static_cast<double>(wanted > 0 ? wanted : encoder::level_of(film.coding).bit_rate);
}

class TuneCommand {
  public:
    TuneCommand(const TrialOptions& options, const std::vector<std::string>& words)
        : options_(options), words_(words), began_(clock_seconds()) {
        tuning_.target = target_of(options);
        check_options(options, tuning_.target);
    }

    /// Finds the setting. Returns whether nobody interrupted.
    bool search();
    int make(const RenderFilm& render_film);
    void write_reports() const;
    const Tuning& tuning() const { return tuning_; }

  private:
    bool quiet() const { return options_.render.quiet; }
    void log(const std::string& text) const {
        if (!quiet()) print(text);
    }
    void settle_options();
    void settle_command() {
        tuning_.command = render_command(words_, options_.render.input, trials_->film().coding.codec, tuning_.options);
    }
    SampleExtent sample_of(const RenderJob& film) const;
    void look_at_film(const Rendered& rendered);

    const TrialOptions& options_;
    const std::vector<std::string>& words_;
    double began_;
    Tuning tuning_;
    std::optional<Trials> trials_;
};

SampleExtent TuneCommand::sample_of(const RenderJob& film) const {
    if (options_.sample) return *options_.sample;
    if (tuning_.target.kind == Kind::time) return {2, 3};
    // chosen: 15 frames: I pictures count by the film's GOPs, and others are alike (9..60); and what is lit twice or
    // three times may not be more than an eighth of the film, so that tuning takes less than half its time.
    const auto eighth = static_cast<int>(std::clamp<std::int64_t>(film.frame_count() / 8, 4, 1000));
    constexpr int whole = 15;
    // chosen: as many frames in windows of five (3 to 8).
    if (tuning_.target.worst_tenth) return {std::clamp(std::min(eighth, 2 * whole) / 5, 1, 6), 5};
    return eighth >= 2 * whole ? SampleExtent{2, whole} : SampleExtent{1, std::min(eighth, whole)};
}

bool TuneCommand::search() {
    const parallel::ThreadLimit threads(options_.render.threads);
    const InterruptGuard guard(quiet());
    const Target& target = tuning_.target;
    const RenderJob film = prepare_trials(options_.render, options_);
    if (InterruptGuard::requested()) return false;
    check_rate(target, film);
    if (!options_.render.dry_run) check_reachable(options_.render.output);

    // Rates need no references.
    const SampleExtent sample = sample_of(film);
    // The worst tenth is often one shot.
    const bool by_shot = target.worst_tenth && !options_.sample;
    trials_.emplace(film, by_shot ? windows_by_shot(film, sample) : middle_windows(film, sample.windows, sample.frames),
                    options_.references.value_or(target.is_rate() ? 0 : 1));
    if (target.worst_tenth) trials_->judge_worst_tenth();
    check_memory(trials_->bytes_held(target.kind != Kind::time));
    const double ready = clock_seconds();
    if (!light_references(*trials_, quiet())) return false;
    log(trial_heading(*trials_) + probe_heads(target));
    const LogProbe log_probe = [&](const Probe& probe) { log(probe_row(target, probe)); };
    const std::optional<double>& quality = options_.render.coding.quality;
    if (target.kind == Kind::time)
        tune_time(*trials_, quality ? at_quality(trials_->film(), *quality) : trials_->film(), ready - began_, quiet(),
                  tuning_, log_probe);
    else
        tune_coding(*trials_, searched(target, film, options_.render.output), quiet(), tuning_, log_probe);
    if (tuning_.found == Found::stopped) return false;
    settle_options();
    return true;
}

void TuneCommand::settle_options() {
    const Target& target = tuning_.target;
    const Probe& chosen = tuning_.probes[*tuning_.chosen];
    if (target.is_quality()) {
        tuning_.options = chosen.choices;
    } else if (target.is_rate()) {
        double rate = searched(target, trials_->film(), options_.render.output).value;
        // A size that the finest film does not fill is reached; but the sample is not the film.
        const bool finest = target.kind == Kind::size && tuning_.found == Found::beyond && *chosen.trial.quality > 50;
        if (finest) {
            tuning_.found = Found::between;
            rate = std::min(rate, highest_rate(trials_->film()));
        }
        tuning_.options = {{"--bitrate", fmt::format("{:.0f}", rate)}};
        // A rate beyond the finest film's gives the finest film.
        if (target.kind == Kind::bitrate && tuning_.found == Found::beyond && *chosen.trial.quality > 50) {
            tuning_.found = Found::between;
            tuning_.options = chosen.choices;
        }
    }
    if (tuning_.found != Found::beyond) settle_command();
}

int TuneCommand::make(const RenderFilm& render_film) {
    // That printed, so that --resume goes on with it.
    CommandLine line = parse(tuning_.command);
    line.render.overwrite = true;  // that was settled before anything was tried
    line.render.quiet = quiet();
    Rendered rendered;
    const int status = render_film(line.render, line.text, &rendered);
    if (status == 0) look_at_film(rendered);
    return status;
}

void TuneCommand::look_at_film(const Rendered& rendered) {
    WholeFilm film;
    film.frames = static_cast<std::int64_t>(rendered.statistics.frames.size());
    film.bytes = static_cast<double>(rendered.bytes);
    film.seconds = rendered.statistics.wall;
    const auto bits = 8 * static_cast<double>(rendered.statistics.rate_outcome().bytes);
    film.bit_rate = ratio_of(bits * trials_->film().rate.hertz.value(), film.frames);
    perceptual::FilmQuality shown;
    for (const FrameEntry& entry : rendered.statistics.frames) shown.add(entry.mse_y, entry.ssim_y);
    if (tuning_.target.worst_tenth) shown = shown.worst_tenth();
    film.psnr_y = shown.psnr_y();
    film.ssim_y = shown.ssim_y();
    film.reference = tuning_.probes[*tuning_.chosen].trial.film_quality({film.psnr_y, film.ssim_y, 0});
    if (tuning_.target.is_quality()) film.setting = std::stod(tuning_.options.front().second);
    tuning_.film = film;
    if (const auto quality = nearer_quality(tuning_)) {
        tuning_.options = {{"--quality", fmt::format("{:.1f}", *quality)}};
        settle_command();
    }
}

void TuneCommand::write_reports() const {
    write_results(options_, *trials_, words_, tune_json(tuning_), [&] {
        return TrialPage{"tune", "tuned to " + target_text(tuning_.target), sentence_of(tuning_),
                         tune_page(trials_->film(), tuning_)};
    });
}

}  // namespace

int tune(const TrialOptions& options, const std::vector<std::string>& words, const RenderFilm& render_film) {
    TuneCommand command(options, words);
    const Tuning& tuning = command.tuning();
    const bool quiet = options.render.quiet;
    if (!command.search()) {
        if (!quiet) print_line("interrupted: nothing was settled");
        return InterruptGuard::status();
    }
    if (!quiet) print_sentence(sentence_of(tuning));
    if (tuning.found == Found::beyond) {
        command.write_reports();
        print_error(target_text(tuning.target) + ": out of reach");
        return 1;
    }
    if (!quiet) print("\n" + line_of(tuning.command) + "\n");
    int status = 0;
    if (!options.render.dry_run) {
        if (!quiet) print("\n");
        command.write_reports();  // the search may have been dear; they are told of the film after it
        // chosen: 3. The second film's setting follows from the first whole one, and has not missed yet.
        constexpr int most_films = 3;
        for (int films = 1;; ++films) {
            status = command.make(render_film);
            if (status != 0) return status;
            if (!quiet) print_sentence(film_sentence(tuning));
            status = film_is_near(tuning) ? 0 : 1;
            if (status == 0 || films == most_films || !nearer_quality(tuning)) break;
            if (!quiet) print("\n" + line_of(tuning.command) + "\n\n");
        }
        if (status != 0) print_error(target_text(tuning.target) + ": the film that was made missed it");
    }
    command.write_reports();
    return status;
}

}  // namespace render2mpeg::app
