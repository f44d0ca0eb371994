#include "app/experiments/trial_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/job/automatic_exposure.h"
#include "app/options/usage_error.h"
#include "app/production/resume.h"
#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"
#include "app/report/report.h"
#include "app/system/error_collector.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/codec.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::app {
namespace {

std::string four_digits(double value) {
    return fmt::format("{:.4f}", value);
}
std::string one_digit(double value) {
    return fmt::format("{:.1f}", value);
}
std::string percent_of(double share) {
    return short_figure(100 * share);
}

constexpr auto number_of = [](const auto& number) { return static_cast<double>(number); };

/// All figures of a trial.
const std::vector<TrialColumn> all_columns{
    {"light_seconds", [](const Trial& t) { return t.seconds; }, "light, s", 8},
    {"code_seconds", [](const Trial& t) { return t.code_seconds; }, "code, s", 8},
    {"rays_per_point", [](const Trial& t) { return t.rays; }, "rays", 6, count_text},
    {"cut", [](const Trial& t) { return t.cut; }, "cut", 5, count_text},
    {"capped", [](const Trial& t) { return t.capped; }},
    {"points", [](const Trial& t) { return number_of(t.points); }},
    {"error_p50", [](const Trial& t) { return t.errors.quantile(0.5); }, "50 %", 5, percent_of},
    {"error_p95", [](const Trial& t) { return t.errors.quantile(0.95); }, "95 %", 5, percent_of},
    {"error_p99", [](const Trial& t) { return t.errors.quantile(0.99); }},
    {"error_pixels", [](const Trial& t) { return number_of(t.errors.count()); }},
    {"over_tolerance", [](const Trial& t) { return t.share_over(); }, "over", 5, percent_of},
    {"over_twice", [](const Trial& t) { return t.share_over_twice(); }},
    {"psnr_y", [](const Trial& t) { return t.film_quality().psnr_y; }, "PSNR-Y", 6, psnr_text},
    {"ssim_y", [](const Trial& t) { return t.film_quality().ssim_y; }, "SSIM", 6, four_digits},
    {"psnr_hvs_m", [](const Trial& t) { return t.film_quality().psnr_hvs_m; }, "HVS-M", 6, psnr_text},
    {"xpsnr_y", [](const Trial& t) { return t.installed.xpsnr_y.mean; }, "XPSNR", 12, psnr_text},
    {"xpsnr_y_low", [](const Trial& t) { return t.installed.xpsnr_y.low; }, "lowest 5 %", 12, psnr_text},
    {"ssimulacra2", [](const Trial& t) { return t.installed.ssimulacra2.mean; }, "SSIMULACRA2", 12, one_digit},
    {"ssimulacra2_low", [](const Trial& t) { return t.installed.ssimulacra2.low; }, "lowest 5 %", 12, one_digit},
    {"lit_psnr_y", [](const Trial& t) { return t.lit.psnr_y(); }},
    {"lit_ssim_y", [](const Trial& t) { return t.lit.ssim_y(); }},
    {"bytes", [](const Trial& t) { return t.bytes; }, "size", 8, size_text},
    {"film_bytes", [](const Trial& t) { return t.film_bytes; }},
    {"kilobits", [](const Trial& t) { return 1e-3 * t.bit_rate; }, "kb/s", 9, one_digit},
    {"requantised", [](const Trial& t) { return number_of(t.requantised); }},
    {"cpu", [](const Trial& t) { return t.cpu; }},
    {"clock", [](const Trial& t) { return t.clock; }}};

const TrialColumn& column(const char* key) {
    return *std::ranges::find(all_columns, std::string_view(key), &TrialColumn::key);
}

}  // namespace

std::string heads_text(const TrialColumns& columns, const std::string& name, int width) {
    std::string text = fmt::format("{:<{}}", name, width);
    for (const char* key : columns) text += fmt::format(" {:>{}}", column(key).head, column(key).width);
    return text + "\n";
}

std::string row_text(const TrialColumns& columns, const std::string& name, int width, const Trial& trial) {
    std::string text = fmt::format("{:<{}}", name, width);
    for (const char* key : columns)
        text += fmt::format(" {:>{}}", column(key).text(column(key).value(trial)), column(key).width);
    if (trial.requantised == 0) return text + "\n";
    // The quantiser of a rate-controlled film says little.
    return text + fmt::format("\n{:<{}} {} of {} pictures coded coarser than that, to fit the buffer\n", "", width,
                              trial.requantised, trial.frames);
}

std::string installed_table(const Trials& trials, int width, const std::vector<NamedTrial>& rows) {
    if (!trials.installed() || trials.references() == 0) return {};
    const InstalledMetrics& metrics = *trials.installed();
    TrialColumns shown;
    if (metrics.has_xpsnr()) shown.insert(shown.end(), {"xpsnr_y", "xpsnr_y_low"});
    if (metrics.has_ssimulacra2() && !trials.film().view.is_hdr())
        shown.insert(shown.end(), {"ssimulacra2", "ssimulacra2_low"});
    std::string text;
    if (!shown.empty()) {
        text = "\nOther programs' metrics of decoded reference frames: mean, lowest twentieth\n" +
               heads_text(shown, "", width);
        for (const auto& [name, trial] : rows) text += row_text(shown, name, width, *trial);
    }
    const std::string missing = metrics.missing();
    constexpr int columns = 80;
    return missing.empty() ? text : text + "\n" + wrapped(missing, columns) + "\n";
}

nlohmann::json figures_json(const Trial& trial) {
    nlohmann::json figures{{"quantiser", trial.quantiser}};
    for (const TrialColumn& c : all_columns) figures[c.key] = finite_or_null(c.value(trial));
    return figures;
}

namespace {

/// Refuses inputs before it asks for consent, and makes folders last.
void check_trial_outputs(const RenderJob& film, const TrialOptions& options) {
    const RenderOptions& render = options.render;
    Wishes wishes;
    if (options.json) wishes.dear.emplace_back(*options.json);
    std::vector<Files> beside = wishes.dear;
    if (options.report) {
        check_report(*options.report);
        wishes.beside.push_back(*options.report);
        beside.emplace_back(*options.report);
        beside.emplace_back(report_json_of(*options.report));
    }
    std::vector<Files> all = beside;
    if (!render.output.empty()) {
        av::check_film(render.output, film.coding.codec, film.sound);
        all.emplace_back(render.output);
        if (!render.dry_run) wishes.dear.emplace_back(render.output);
    }
    check_apart(inputs_of(film, render), all);
    require_consent(wishes, render.overwrite);
    for (const Files& output : beside) check_writable(output.name);
}

}  // namespace

std::vector<std::string> render_command(const std::vector<std::string>& words, const std::filesystem::path& input,
                                        encoder::Codec codec, Choices with) {
    std::vector<std::string> without(options_of_trials.begin(), options_of_trials.end());
    std::vector<std::string> flags{"--quiet", "--dry-run"};
    const auto is_output = [](const std::string& word) {
        return word == "-o" || word == "--output" || word.starts_with("--output=");
    };
    const bool named = std::ranges::any_of(words, is_output) ||
                       std::ranges::any_of(with, [](const auto& option) { return option.first == "-o"; });
    if (!named) {
        // Consent was to other files.
        flags.insert(flags.end(), {"-y", "--overwrite"});
        with.emplace_back("-o", std::filesystem::absolute(input).lexically_normal().stem().string() +
                                    std::string(encoder::facts_of(codec).usual_ending()));
    }
    for (const auto& [name, value] : with) {
        without.push_back(name);
        if (name == "--quantiser") without.emplace_back("-q");
    }
    return changed_command(words, "render", without, flags, with);
}

RenderJob prepare_trials(const RenderOptions& render, const TrialOptions& options) {
    RenderJob film = prepare(render);
    if (const encoder::CodecFacts& codec = encoder::facts_of(film.coding.codec); codec.master)
        throw UsageError(std::string(codec.name) +
                         ": a master has no quantisers to try; choose another codec, or `render`");
    if (film.is_stereo() && !options.beside)
        throw UsageError("stereo: settings are tried on films for one eye; say --stereo none");
    for (const std::string& note : film.animation->notes)
        if (!render.quiet && !note.empty()) print_line(note);
    check_trial_outputs(film, options);
    if (!film.images->read_ahead(image_probes(false))) return film;
    if (!film.exposure) film.exposure = told("exposure", render.quiet, [&] { return measure_exposure(film); });
    return film;
}

void check_memory(double bytes, double machine) {
    if (bytes > machine)
        throw core::Error(
            fmt::format("the sample's references and frames take {:.1f} GB of memory, of {:.1f} GB that "
                        "there are: try less (--sample, --size)",
                        bytes / 1e9, machine / 1e9));
}
void check_memory(double bytes) {
    check_memory(bytes, static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

int interrupted_before_rows(bool quiet) {
    if (!quiet) print_line("interrupted before the first row: nothing was found out");
    return InterruptGuard::status();
}

bool light_references(Trials& trials, bool quiet) {
    const int wanted = trials.wanted_references();
    std::optional<Progress> progress;
    const auto begin = [&](bool silent) { progress.emplace(wanted, silent, "reference", Counted::parts_of_step); };
    if (wanted > 0) begin(quiet || !shows_steps());
    return trials.light_references(
        [&](double seconds) {
            progress.reset();
            if (!quiet && seconds > 1)
                print_line(fmt::format("lighting {} takes about {}; interrupt to leave it",
                                       wanted == 1 ? "the reference" : "the references", clock_text(seconds)));
            begin(quiet);
        },
        [&] { return advancing(*progress)(); });
}

void find_truth(Trials& trials, bool quiet) {
    // chosen: 1,024 pixels take some 30 CPU seconds, and tell what reference light lacks to a twentieth (64 to 4,096).
    constexpr std::size_t most = 1024;
    told("truth", quiet, [&] { trials.find_truth(most); });
}

std::string truth_text(const std::optional<PathTruth>& truth) {
    if (!truth) return {};
    return fmt::format(
        "PSNR-Y: against the truth, which is this light, mended by unbiased paths of {} of {} pixels. It is at least "
        "{} dB from these. SSIM, HVS-M and errors of light: against this light itself.",
        truth->pixels, truth->of, psnr_text(truth->psnr_y));
}

std::optional<Tried> run_trial(Trials& trials, const Setting& setting, bool quiet, LitWindows* keep) {
    Progress progress(trials.frames(), quiet || !shows_steps(), setting.name, Counted::frames_of_step);
    const std::optional<Trial> trial = trials.run(setting.film, advancing(progress), keep);
    return trial ? std::optional(Tried{setting.name, setting.choices, *trial}) : std::nullopt;
}

RenderJob with_tolerance(RenderJob film, const ToleranceRequest& tolerance) {
    film.tolerance = tolerance;
    film.coupling.fraction = tolerance.fraction;
    film.coupling.loss = tolerance.loss;
    return film;
}

std::string trial_heading(const Trials& trials) {
    const RenderJob& film = trials.film();
    std::string text =
        fmt::format("{}: {} of {} frames of {}x{} in {}\n", film.animation->source, trials.frames(), film.frame_count(),
                    film.format.width, film.format.height, core::counted(trials.windows().size(), "window"));
    if (trials.references() == 0) return text + "quality against these frames as they were lit\n";
    const renderer::Statistics& found = trials.statistics();
    const bool rays = film.rendering.indirect == renderer::Indirect::rays && film.rendering.vpls > 0;
    text += fmt::format("{} by {} light points{} as reference, {} s of CPU each\n", trials.references(),
                        found.direct_points + found.indirect_points,
                        rays ? fmt::format(" and {} rays a point", renderer::most_gather_rays) : "",
                        short_figure(trials.reference_seconds()));
    constexpr int columns = 80;
    return trials.truth() ? text + wrapped(truth_text(trials.truth()), columns) + "\n" : text;
}

void print_sentence(const std::string& text) {
    if (!text.empty()) print("\n" + wrapped(text, std::clamp(columns_of_output(), 60, 110)) + "\n");
}

namespace {

/// The figures and what all commands know.
nlohmann::json with_head(nlohmann::json figures, const Trials& trials, const std::string& command) {
    const RenderJob& film = trials.film();
    nlohmann::json windows = nlohmann::json::array();
    for (const Chunk& window : trials.windows()) windows.push_back({window.first, window.last});
    const bool quantised = film.coupling.strategy == perceptual::Strategy::quantised;
    nlohmann::json truth;
    if (const auto& t = trials.truth())
        truth = {{"pixels", t->pixels},
                 {"of_pixels", t->of},
                 {"seconds", t->seconds},
                 {"psnr_y", finite_or_null(t->psnr_y)}};
    figures.update({{"command", command},
                    {"truth", truth},
                    {"version", RENDER2MPEG_VERSION},
                    {"isa", core::name_of(film.rendering.isa)},
                    {"input", film.animation->source},
                    {"width", film.format.width},
                    {"height", film.format.height},
                    {"fps", film.rate.hertz.value()},
                    {"exposure", film.exposure.value_or(0)},
                    {"view", core::text_of(film.view)},
                    {"quantiser", film.coding.quantiser},
                    {"gop", film.coding.gop},
                    {"samples", film.rendering.samples},
                    {"edge_samples", film.rendering.edge_samples},
                    {"vpls", film.rendering.vpls},
                    {"masking", quantised ? "quantised" : "warped"},
                    {"cache", cache_word(film.rendering)},
                    {"windows", windows},
                    {"light_points", trials.statistics().direct_points + trials.statistics().indirect_points},
                    {"reference", {{"frames", trials.references()}, {"seconds", trials.reference_seconds()}}}});
    return figures;
}

}  // namespace

void write_results(const TrialOptions& options, const Trials& trials, const std::vector<std::string>& words,
                   const nlohmann::json& found, const std::function<TrialPage()>& page) {
    const nlohmann::json figures = with_head(found, trials, line_of(words));
    ErrorCollector errors;
    if (options.json) errors.attempt([&] { write_json(*options.json, figures); });
    if (options.report)
        errors.attempt([&] {
            const std::filesystem::path source = trials.film().animation->source;
            const std::string name = (source.has_filename() ? source : source.parent_path()).filename().string();
            TrialPage made = page();
            made.more.update(
                {{"kind", made.kind}, {"title", name + ": " + made.title}, {"lead", made.lead}, {"figures", figures}});
            write_page(*options.report, made.more);
            write_json(report_json_of(*options.report), figures);
        });
    errors.rethrow();
}

nlohmann::json sample_frame_figures(const std::string& name, const Trial& trial, const RenderJob& film) {
    nlohmann::json all = nlohmann::json::array();
    if (!trial.sample_frame) return all;
    const SampleFrame& own = *trial.sample_frame;
    // Both figures share one scale.
    perceptual::HeatScale error = scale_of(HeatSubject::tolerance);
    error.title = "TRUE ERROR / LUMINANCE";
    all.push_back(pair_of(fmt::format("Frame {}: {} decoded, beside reference light, not coded", own.frame, name),
                          {name, own.decoded}, {"reference light", own.reference}, film.colors(), false));
    all.push_back(heat_of("What each pixel's light may be off by", own.tolerance, scale_of(HeatSubject::tolerance)));
    all.push_back(heat_of("What it is off by", own.error, error));
    return all;
}

}  // namespace render2mpeg::app
