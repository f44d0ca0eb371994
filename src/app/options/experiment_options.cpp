#include "app/options/experiment_options.h"

#include "app/options/coding_options.h"
#include "app/options/option_text.h"
#include "app/options/scene_options.h"
#include "core/isa.h"

namespace render2mpeg::app {
namespace {

/// What a sweep sets itself, or what says nothing of a film's sample.
constexpr const char* unwanted[] = {"--tolerance", "--quality", "--bitrate", "--cbr", "--maxrate", "--vbv", "--passes"};

void add_sweep_options(CLI::App& command, CostOptions& options) {
    const std::string sweep = "What is tried";
    command
        .add_option("--sample", options.sample,
                    "Windows spread over the film, by consecutive frames of each; the last frame of each window is "
                    "also lit as the reference (default: as --within allows, at most 2x3)")
        ->type_name("WINDOWSxFRAMES")
        ->check(checked(sample_from, ""))
        ->group(sweep);
    command.add_option("--within", options.within, "Choose a sample that takes about so long, where --sample does not")
        ->type_name("TIME")
        ->check(checked(time_in_seconds, ""))
        ->capture_default_str()
        ->group(sweep);
    command.add_option("--tolerances", options.tolerances, "Fixed tolerances, per cent of a pixel's luminance")
        ->type_name("P,P,...")
        ->check(checked(percents_from, ""))
        ->capture_default_str()
        ->group(sweep);
    command
        .add_option("--quantisers", options.quantisers,
                    "Quantisers to couple light to, each beside a fixed 2 % coded with it; or `none` (default: the "
                    "film's own)")
        ->type_name("Q,Q,...|none")
        ->check(checked(quantisers_from, ""))
        ->group(sweep);
}

void add_foreign_film(CLI::App& command, CompareOptions& options) {
    const std::string tried = "What is tried";
    CLI::Option* film = command
                            .add_option("--film", options.film,
                                        "Also tell the size and quality of this film, made by another renderer, "
                                        "against its own --reference")
                            ->type_name("FILE")
                            ->group(tried);
    command
        .add_option("--reference", options.reference,
                    "What --film should look like: a folder of numbered images (EXR as scene light, PNG as shown), or "
                    "their pattern; their first is the film's first frame")
        ->type_name("DIR|PATTERN")
        ->needs(film)
        ->group(tried);
    film->needs("--reference");
}

}  // namespace

template <class Options>
void add_trial_run_options(CLI::App& command, Options& options) {
    const std::string run = "Run";
    command
        .add_option("-j,--threads", options.render.threads,
                    "Threads; 0: one per core. Nothing but the clock depends on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str()
        ->group(run);
    command.add_option("--isa", options.render.isa, "Instruction set (default: the best there is)")
        ->type_name("sse2|sse4.2|avx|avx2|avx512")
        ->check(checked(core::isa_from, ""))
        ->group(run);
    command
        .add_option("--keep-references", options.kept_references,
                    "Keep frames lit as the reference in this folder, and take them from there where nothing has "
                    "changed")
        ->type_name("DIR")
        ->group(run);
    command.add_option("--json", options.json, "Write all figures as JSON")->type_name("FILE.json")->group(run);
    command
        .add_option("--report", options.report, "Write a page with plots for any browser, and its figures beside it")
        ->type_name("FILE.html")
        ->group(run);
    add_consent_option(command, options.render.overwrite);
    command.add_flag("--quiet", options.render.quiet, "Print nothing but errors")->group(run);
}
template void add_trial_run_options(CLI::App& command, CostOptions& options);
template void add_trial_run_options(CLI::App& command, TuneOptions& options);
template void add_trial_run_options(CLI::App& command, CompareOptions& options);

CLI::App* add_cost_command(CLI::App& app, CostOptions& options) {
    CLI::App* command = app.add_subcommand("cost", "Show what accuracy costs in time, and what it buys");
    command->footer(
        "Lights a sample of the film with one tolerance after the other, and coupled to its coding; tells what the "
        "whole "
        "film takes with each, what one sees of it, and the true errors behind that (docs/choosing.md). The reference "
        "is dear: it comes first, with an estimate.\n"
        "Example: render2mpeg cost scene.glb --size 320x180 --vpls 1000 --report cost.html");
    add_scene_options(*command, options.render);
    add_sweep_options(*command, options);
    add_picture_options(*command, options.render);
    add_light_options(*command, options.render);
    add_coding_options(*command, options.render.coding);
    for (const char* name : unwanted) command->remove_option(command->get_option(name));
    add_trial_run_options(*command, options);
    return command;
}

CLI::App* add_compare_command(CLI::App& app, CompareOptions& options) {
    CLI::App* command = app.add_subcommand("compare", "Compare with rendering first and encoding with ffmpeg then");
    command->footer(
        "Lights a sample of the film coupled to its coding and by a fixed 2 %, codes the latter by this program, by "
        "ffmpeg as people use it and by its strongest command, and holds all against reference light "
        "(docs/choosing.md). Needs the program ffmpeg. The references are dear: they come first, with an estimate.\n"
        "Example: render2mpeg compare scene.glb --size 640x360 --report compare.html");
    add_scene_options(*command, options.render);
    const std::string tried = "What is tried";
    command
        ->add_option("--sample", options.sample,
                     "Windows spread over the film, by consecutive frames of each; better whole GOPs")
        ->type_name("WINDOWSxFRAMES")
        ->check(checked(sample_from, ""))
        ->capture_default_str()
        ->group(tried);
    command
        ->add_option("--references", options.references,
                     "Frames of each window that are also lit as the reference, in adjacent pairs where there are "
                     "several: they tell what light adds to the errors of all frames, and their pairs flicker")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str()
        ->group(tried);
    command->add_option("--quantisers", options.quantisers, "Quantisers to code with, two or more")
        ->type_name("Q,Q,...")
        ->check(checked(quantisers_from, ""))
        ->capture_default_str()
        ->group(tried);
    command
        ->add_option("--runs", options.runs,
                     "Runs of everything that is timed, one way after the other and over again; times are their "
                     "medians, told with their spread")
        ->check(CLI::Range(1, 100))
        ->capture_default_str()
        ->group(tried);
    add_foreign_film(*command, options);
    add_picture_options(*command, options.render);
    add_light_options(*command, options.render);
    add_coding_options(*command, options.render.coding);
    for (const char* name : unwanted) command->remove_option(command->get_option(name));
    for (const char* name : {"--quantiser", "--for", "--keyframes"}) command->remove_option(command->get_option(name));
    command->get_option("--gop")->default_str("15");  // short_gop
    add_trial_run_options(*command, options);
    return command;
}

}  // namespace render2mpeg::app
