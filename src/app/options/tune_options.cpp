#include "app/options/tune_options.h"

#include "app/options/coding_options.h"
#include "app/options/experiment_options.h"
#include "app/options/option_text.h"
#include "app/options/rate_options.h"
#include "app/options/scene_options.h"

namespace render2mpeg::app {
namespace {

/// What is found out instead, or would make it another film than the sample.
constexpr const char* decided_by_tune[] = {"--bitrate", "--cbr", "--passes"};

void add_targets(CLI::App& command, TuneOptions& options) {
    const std::string target = "What is to be reached (one of these)";
    add_option(command, target, "--target-psnr", options.psnr,
               "PSNR-Y in dB of the decoded pictures, to 0.1 dB on the sample: finds --quality", "DB",
               CLI::Range(1.0, 99.0));
    add_option(command, target, "--target-ssim", options.ssim, "Their SSIM, to 0.002 on the sample: finds --quality",
               "SSIM", CLI::Range(0.01, 0.9999));
    add_option(command, target, "--of", options.of,
               "Whose PSNR or SSIM that is: the whole film's, or that of its worst-tenth of pictures",
               CLI::IsMember({"film", "worst-tenth"}), shown);
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
               "N", CLI::Range(0, 1000));
}

}  // namespace

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
