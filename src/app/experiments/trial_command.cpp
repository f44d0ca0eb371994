#include "app/experiments/trial_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/loop/resume.h"
#include "app/options/help_format.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"
#include "app/report/report.h"
#include "app/system/interrupt.h"
#include "app/system/probes.h"
#include "app/system/terminal.h"
#include "core/error.h"

namespace render2mpeg::app {

void require_trial_consent(const TrialOptions& options) {
    Wishes wishes{{}, {options.json.value_or(""), options.report.value_or("")}};
    const RenderOptions& render = options.render;
    if (!render.output.empty() && !render.dry_run) wishes.films.emplace_back(render.output);
    require_consent(wishes, render.overwrite);
}

std::string render_command(const std::vector<std::string>& words, const std::filesystem::path& input,
                           encoder::Codec codec, std::vector<std::pair<std::string, std::string>> with) {
    std::vector<std::string> without{"--sample", "--within", "--tolerances",      "--quantisers",
                                     "--json",   "--report", "--keep-references", "--references",
                                     "--runs",   "--film",   "--reference"};
    for (const auto& [name, value] : with) {
        without.push_back(name);
        if (name == "--quantiser") without.emplace_back("-q");
    }
    if (std::none_of(with.begin(), with.end(), [](const auto& option) { return option.first == "-o"; }))
        with.emplace_back("-o",
                          std::filesystem::absolute(input).lexically_normal().stem().string() + usual_ending(codec));
    return line_of(changed_command(words, "render", without, {"--quiet", "-y"}, with));
}

void check_trial_outputs(const RenderJob& film, const TrialOptions& options) {
    std::vector<Files> outputs{options.json.value_or("")};
    if (options.report) {
        check_report(*options.report);
        outputs.emplace_back(*options.report);
        outputs.emplace_back(report_json_of(*options.report));
    }
    for (const Files& output : outputs)
        if (!output.name.empty()) check_writable(output.name);
    if (!options.render.output.empty()) outputs.emplace_back(options.render.output);
    check_apart(inputs_of(film, options.render), outputs);
}

RenderJob prepare_trials(const RenderOptions& options) {
    RenderJob film = prepare(options);
    for (const std::string& note : film.animation->notes)
        if (!options.quiet && !note.empty()) print_line(note);
    if (!probe_images(*film.animation, image_probes(false))) return film;
    if (!film.exposure) {
        const Progress progress(1, options.quiet || !shows_steps(), "exposure", Counted::parts_of_step);
        film.exposure = measure_exposure(film);
    }
    return film;
}

std::string memory_note(double bytes, double machine) {
    const std::string held = fmt::format("the sample's references and frames take {:.1f} GB of memory", bytes / 1e9);
    if (bytes > machine)
        throw core::Error(held +
                          fmt::format(", of {:.1f} GB that there are: try less (--sample, --size)", machine / 1e9));
    // chosen: what a machine that renders can spare without a word (0.5..4 GB).
    return bytes > 1e9 ? held + "; a smaller --sample takes less" : "";
}

void print_memory_note(double bytes, bool quiet) {
    const double machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    const std::string note = memory_note(bytes, machine);
    if (!quiet && !note.empty()) print_line(note);
}

bool light_references(Trials& trials, bool quiet) {
    // The first part includes making the lights.
    auto progress = std::make_unique<Progress>(1, quiet || !shows_steps(), "reference", Counted::parts_of_step);
    bool begun = false;
    return trials.light_references([&](const ReferenceStanding& standing) {
        if (!begun) {
            begun = true;
            progress.reset();
            if (!quiet && standing.seconds_left() > 1)
                print_line(fmt::format("lighting {} takes about {}; interrupt to leave it",
                                       standing.parts == 1 ? "the reference" : "the references",
                                       clock_text(standing.seconds + standing.seconds_left())));
            progress = std::make_unique<Progress>(standing.parts, quiet, "reference", Counted::parts_of_step,
                                                  standing.seconds);
        }
        progress->advance_to(standing.done, standing.parts);
        return !InterruptGuard::requested();
    });
}

std::optional<Trial> run_trial(Trials& trials, const ToleranceRequest& tolerance, const Coarseness& coarseness,
                               const std::string& name, bool quiet, LitWindows* keep) {
    Progress progress(trials.frames(), quiet || !shows_steps(), name, Counted::frames_of_step);
    return trials.run(
        tolerance, coarseness,
        [&] {
            progress.advance();
            return !InterruptGuard::requested();
        },
        keep);
}

void print_sentence(const std::string& text) {
    if (!text.empty()) print("\n" + wrapped(text, std::clamp(columns_of_output(), 60, 110)) + "\n");
}

using nlohmann::json;

json trial_json(const RenderJob& film, const std::string& command, const std::vector<Chunk>& windows, int references,
                double reference_seconds) {
    json frames = json::array();
    for (const Chunk& window : windows) frames.push_back({window.first, window.last});
    return {{"command", command},
            {"version", RENDER2MPEG_VERSION},
            {"isa", core::name_of(film.rendering.isa)},
            {"input", film.animation->source},
            {"width", film.format.width},
            {"height", film.format.height},
            {"fps", film.rate.hertz.value()},
            {"windows", frames},
            {"reference", {{"frames", references}, {"seconds", reference_seconds}}}};
}

json light_json(const RenderJob& film) {
    return {{"samples", film.rendering.samples},
            {"edge_samples", film.rendering.edge_samples},
            {"vpls", film.rendering.vpls},
            {"masking", film.coupling.strategy == perceptual::Strategy::quantised ? "quantised" : "warped"},
            {"cache", cache_word(film.rendering)}};
}

json quality_json(double psnr_y, double ssim_y) {
    return {{"psnr_y", finite_or_null(psnr_y)}, {"ssim_y", ssim_y}};
}

std::string sample_frame_figures(const std::string& name, const Trial& trial, const RenderJob& film) {
    if (!trial.sample_frame) return {};
    const SampleFrame& own = *trial.sample_frame;
    // Both figures share one scale.
    perceptual::HeatScale error = scale_of(HeatSubject::tolerance);
    error.title = "TRUE ERROR / LUMINANCE";
    return slider_figure(fmt::format("Frame {}: {} decoded, beside reference light, not coded", own.frame, name),
                         {name, own.decoded}, {"reference light", own.truth},
                         perceptual::matrix_for(film.format.height)) +
           heat_figure("What each pixel's light may be off by", own.tolerance, scale_of(HeatSubject::tolerance)) +
           heat_figure("What it is off by", own.error, error);
}

std::string decoded_pair(const std::string& title, const std::string& name, const Trial& trial,
                         const std::string& other_name, const Trial& other, const RenderJob& film) {
    if (!trial.sample_frame || !other.sample_frame) return {};
    return slider_figure(title, {name, trial.sample_frame->decoded}, {other_name, other.sample_frame->decoded},
                         perceptual::matrix_for(film.format.height));
}

void write_trial_page(const std::filesystem::path& html, const RenderJob& film, const std::string& title,
                      const std::string& lead, const std::string& body, const std::string& command,
                      const std::string& guide, const json& figures) {
    const std::filesystem::path source = film.animation->source;
    const std::string name = (source.has_filename() ? source : source.parent_path()).filename().string();
    write_whole(html, report_page(name + ": " + title, lead,
                                  body + "<h2>To find it out again</h2>\n<pre>" + escaped(command) +
                                      "</pre>\n<p class=\"soft\">Every figure is in the JSON file beside this page (" +
                                      guide + ").</p>\n"));
    write_json(report_json_of(html), figures);
}

}  // namespace render2mpeg::app
