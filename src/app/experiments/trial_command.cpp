#include "app/experiments/trial_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/loop/film_identity.h"
#include "app/options/help_format.h"
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
                           std::vector<std::pair<std::string, std::string>> with) {
    std::vector<std::string> without{"--sample", "--within", "--tolerances",      "--quantisers",
                                     "--json",   "--report", "--keep-references", "--references",
                                     "--runs",   "--film",   "--reference"};
    for (const auto& [name, value] : with) {
        without.push_back(name);
        if (name == "--quantiser") without.emplace_back("-q");
    }
    if (std::none_of(with.begin(), with.end(), [](const auto& option) { return option.first == "-o"; }))
        with.emplace_back("-o", std::filesystem::absolute(input).lexically_normal().stem().string() + ".mpg");
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

}  // namespace render2mpeg::app
