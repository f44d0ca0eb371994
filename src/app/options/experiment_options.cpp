#include "app/options/experiment_options.h"

#include "app/options/option_text.h"
#include "app/options/rate_options.h"
#include "app/options/scene_options.h"
#include "core/isa.h"

namespace render2mpeg::app {
namespace {

/// Options that a sweep sets itself.
constexpr const char* unwanted[] = {"--tolerance", "--quality", "--bitrate", "--cbr", "--maxrate", "--vbv", "--passes"};

void add_sweep_options(CLI::App& command, CostOptions& options) {
    const std::string sweep = "What is tried";
    add_option(command, sweep, "--sample", options.sample,
               "Windows spread over the film, by consecutive frames of each; the last frame of each window is "
               "also lit as the reference (default: as --within allows, at most 2x3)",
               "WINDOWSxFRAMES", sample_from);
    add_option(command, sweep, "--within", options.within,
               "Choose a sample that takes about so long, where --sample does not", "TIME", time_in_seconds, shown);
    add_option(command, sweep, "--tolerances", options.tolerances, "Fixed tolerances, per cent of a pixel's luminance",
               "P,P,...", percents_from, shown);
    add_option(command, sweep, "--quantisers", options.quantisers,
               "Quantisers to couple light to, each beside a fixed 2 % coded with it; or `none` (default: the "
               "film's own)",
               "Q,Q,...|none", quantisers_from);
}

void add_foreign_film(CLI::App& command, CompareOptions& options) {
    const std::string tried = "What is tried";
    CLI::Option* film = add_option(command, tried, "--film", options.film,
                                   "Also tell the size and quality of this film, made by another renderer, "
                                   "against its own --reference",
                                   "FILE");
    add_option(command, tried, "--reference", options.reference,
               "What --film should look like: a folder of numbered images (EXR as scene light, PNG as shown), or "
               "their pattern; their first is the film's first frame",
               "DIR|PATTERN")
        ->needs(film);
    film->needs("--reference");
}

/// Options that `tune` decides, or that would change the film.
constexpr const char* decided_by_tune[] = {"--bitrate", "--cbr", "--passes"};

void add_targets(CLI::App& command, TuneOptions& options) {
    const std::string target = "What is to be reached (one of these)";
    add_option(command, target, "--target-psnr", options.psnr,
               "PSNR-Y in dB of the decoded pictures, to 0.1 dB on the sample: finds --quality", "DB",
               range(1.0, 99.0));
    add_option(command, target, "--target-ssim", options.ssim, "Their SSIM, to 0.002 on the sample: finds --quality",
               "SSIM", range(0.01, 0.9999));
    add_option(command, target, "--of", options.of,
               "Whose PSNR or SSIM that is: the whole film's, or that of its worst-tenth of pictures",
               one_of({"film", "worst-tenth"}), shown);
    add_option(command, target, "--target-bitrate", options.bitrate,
               "Bits per second of pictures, to 2 %: --bitrate in two passes, and what quality that is", "RATE",
               [](const std::string& text) { bits_from(text, "target-bitrate"); });
    add_option(command, target, "--max-size", options.size, "Bytes of the file at most, e.g. 700M: likewise", "SIZE",
               size_in_bytes);
    add_option(command, target, "--max-time", options.time,
               "Time on the clock at most, e.g. 2h or 90m: loosens --tolerance, --samples and --vpls as far as "
               "needed",
               "TIME", time_in_seconds);
}

void add_tried(CLI::App& command, TuneOptions& options) {
    const std::string tried = "What is tried";
    add_option(command, tried, "--sample", options.sample,
               "Windows spread over the film, by consecutive frames of each (default: an eighth of the film, at most "
               "2x15; with --max-time 2x3)",
               "WINDOWSxFRAMES", sample_from);
    add_option(command, tried, "--references", options.references,
               "Frames of each window that are also lit as the reference, which is dear: they tell what light adds "
               "to the errors of all frames. 0: quality is told against the pictures as they were lit (default: 1; "
               "with --target-bitrate and --max-size 0)",
               "N", range(0, 1000));
}

}  // namespace

void add_trial_run_options(CLI::App& command, TrialOptions& options) {
    const std::string run = "Run";
    add_option(command, run, "-j,--threads", options.render.threads,
               "Threads; 0: one per core. Nothing but the clock depends on it", range(0, 1024), shown);
    add_option(command, run, "--isa", options.render.isa, "Instruction set (default: the best there is)",
               "sse2|sse4.2|avx|avx2|avx512", core::isa_from);
    add_option(command, run, "--keep-references", options.kept_references,
               "Keep frames lit as the reference in this folder, and take them from there where nothing has "
               "changed",
               "DIR");
    add_option(command, run, "--json", options.json, "Write all figures as JSON", "FILE.json");
    add_option(command, run, "--report", options.report,
               "Write a page with plots for any browser, and its figures beside it", "FILE.html");
    add_consent_option(command, options.render.overwrite);
    add_flag(command, run, "--quiet", options.render.quiet, "Print nothing but errors");
}

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
    add_option(*command, tried, "--sample", options.sample,
               "Windows spread over the film, by consecutive frames of each; better whole GOPs", "WINDOWSxFRAMES",
               sample_from, shown);
    add_option(*command, tried, "--references", options.references,
               "Frames of each window that are also lit as the reference, in adjacent pairs where there are "
               "several: they tell what light adds to the errors of all frames, and their pairs flicker",
               range(1, 1000), shown);
    add_option(*command, tried, "--quantisers", options.quantisers, "Quantisers to code with, two or more", "Q,Q,...",
               quantisers_from, shown);
    add_option(*command, tried, "--runs", options.runs,
               "Runs of everything that is timed, one way after the other and over again; times are their "
               "medians, told with their spread",
               range(1, 100), shown);
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

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options) {
    CLI::App* command = app.add_subcommand("tune", "Find the setting that reaches a quality, rate, size or time");
    command->footer(
        "Tries a sample of the film, each try a row of a table, then renders the film and tells what became of it "
        "(docs/choosing.md). Exit status 1 where the target is out of reach, or the film missed it.\n"
        "Example: render2mpeg tune scene.glb --target-psnr 40 --dry-run");
    add_scene_options(*command, options.render);
    command->add_option("-o,--output", options.render.output, "Film to make; with --dry-run not needed")
        ->type_name("OUT");
    add_targets(*command, options);
    add_tried(*command, options);
    add_picture_options(*command, options.render);
    add_light_options(*command, options.render);
    add_coding_options(*command, options.render.coding);
    add_sound_options(*command, options.render.coding);
    for (const char* name : decided_by_tune) command->remove_option(command->get_option(name));
    add_trial_run_options(*command, options);
    add_flag(*command, "Run", "--dry-run", options.render.dry_run,
             "Render nothing in the end: print the command that would do it");
    return command;
}

}  // namespace render2mpeg::app
