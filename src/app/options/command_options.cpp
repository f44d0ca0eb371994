#include "app/options/command_options.h"

#include <string>
#include <vector>

#include "app/options/option_text.h"
#include "app/options/options.h"
#include "app/options/rate_options.h"
#include "app/options/scene_options.h"
#include "app/options/usage_error.h"
#include "app/system/memory_limit.h"
#include "core/rational.h"
#include "core/view.h"

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

void add_motion_options(CLI::App& command, EncodeOptions& options) {
    add_option(command, "Motion", "--motion", options.motion,
               "Numbered OpenEXR files with the frames' exact motion; or a motion stream, which other programs write "
               "beside their pictures: fd:N, an open descriptor, or PIPE.motion",
               "PATTERN|fd:N|PIPE.motion");
    add_option(command, "Motion", "--motion-convention", options.motion_convention,
               "What their channels mean: blender or nuke", one_of({"blender", "nuke"}), shown);
}

constexpr const char* farm_group = "Farm";
constexpr const char* farm_run_group = "Run";

void add_plan_argument(CLI::App& command, std::filesystem::path& plan) {
    command.add_option("PLAN", plan, "The folder that `farm` wrote, e.g. film.mpg.farm, or its plan.json")->required();
}

void add_trial_run_options(CLI::App& command, TrialOptions& options) {
    const std::string run = "Run";
    add_threads_option(command, options.render.threads);
    add_isa_option(command, options.render.isa);
    add_option(command, run, "--json", options.json, "Write all figures as JSON", "FILE.json");
    add_option(command, run, "--report", options.report,
               "Write a page with plots for any browser, and its figures beside it", "FILE.html");
    add_consent_option(command, options.render.overwrite);
    add_flag(command, run, "--quiet", options.render.quiet, "Print nothing but errors");
}

}  // namespace

CLI::App* add_cost_command(CLI::App& app, CostOptions& options) {
    CLI::App* command = app.add_subcommand("cost", "Show what accuracy costs in time, and what it buys");
    command->footer(
        "Lights a sample of the film with one tolerance after the other, coupled to its coding and by each --effort; "
        "tells what the whole film takes with each, and by unbiased paths, and what one sees of it "
        "(docs/choosing.md). The reference is dear: it comes first, with an estimate.\n"
        "Example: render2mpeg cost scene.glb --size 320x180 --vpls 1000 --report cost.html");
    add_scene_options(*command, options.render);
    add_sweep_options(*command, options);
    add_film_options(*command, options.render);
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
               "Frames of each window that are also lit as the reference: they tell what light adds to the errors of "
               "all frames",
               range(1, 1000), shown);
    add_option(*command, tried, "--quantisers", options.quantisers, "Quantisers to code with, two or more", "Q,Q,...",
               quantisers_from, shown);
    add_film_options(*command, options.render);
    for (const char* name : unwanted) command->remove_option(command->get_option(name));
    for (const char* name : {"--quantiser", "--for", "--keyframes"}) command->remove_option(command->get_option(name));
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
    add_film_options(*command, options.render);
    add_sound_options(*command, options.render.coding);
    for (const char* name : decided_by_tune) command->remove_option(command->get_option(name));
    add_trial_run_options(*command, options);
    add_flag(*command, "Run", "--dry-run", options.render.dry_run,
             "Render nothing in the end: print the command that would do it");
    return command;
}

CLI::App* add_encode_command(CLI::App& app, EncodeOptions& options) {
    CLI::App* command = app.add_subcommand("encode", "Encode frames and motion of any renderer");
    command->footer(
        "Motion: OpenEXR files with the number of their frame, as `render --aov` writes them (docs/coding.md).\n"
        "Example: render2mpeg encode shot.%04d.exr -o shot.mpg --motion shot.%04d.exr --exposure 0.5");
    command
        ->add_option("FRAMES", options.input,
                     "A .y4m file (8-bit 4:2:0), numbered images: frames.%04d.exr (scene-linear) or .png; or `-`: Y4M "
                     "from standard input, as another program makes it")
        ->required();
    command
        ->add_option("-o,--output", options.output,
                     "Film to write: .mpg, .vob, .ts, .m2v, .mkv, .mp4 or .mov; `-`: standard output")
        ->type_name("OUT")
        ->required();
    add_as_option(*command, options.as, {"ts", "m2v"});
    const std::string picture = "Picture and time", run = "Run";
    add_option(*command, picture, "-r,--fps", options.rate, "Pictures per second (default: the Y4M file's, or 25)",
               "23.976|24|25|29.97|30|50|59.94|60", core::frame_rate_from);
    add_option(*command, picture, "--frames", options.frames,
               "First and last frame, both included: numbers of the images, or places in the Y4M file from 0 "
               "(default: all)",
               "A:B", frames_from);
    add_shape_options(*command, options.coding);
    add_option(*command, picture, "--exposure", options.exposure, "EV for scene-linear frames (default: 0)", "EV",
               range(-64.0f, 64.0f));
    add_option(*command, picture, "--view", options.view,
               "As for render; PNG frames of Blender's views keep their code values (default: neutral)", "NAME",
               core::view_from);
    add_motion_options(*command, options);
    add_coding_options(*command, options.coding);
    add_sound_options(*command, options.coding);
    add_threads_option(*command, options.threads);
    add_option(*command, run, "--stats", options.stats, "Write statistics as JSON (docs/json.md)", "FILE.json");
    add_consent_option(*command, options.overwrite);
    add_flag(*command, run, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_info_command(CLI::App& app, InfoOptions& options) {
    CLI::App* command = app.add_subcommand("info", "Show how the pictures of a film are coded");
    command->footer(
        "Whose encoder made the file does not matter. Exit status 1 where pictures are damaged (docs/first-film.md).\n"
        "Example: render2mpeg info film.mpg --summary");
    command->add_option("FILE", options.input, "Film in any container, or a bare MPEG-2 video stream")->required();
    command->add_flag("--json", options.json, "Print JSON instead of tables");
    command->add_flag("--summary", options.summary, "Leave out the pictures one by one");
    return command;
}

void add_spreading_options(CLI::App& command, FarmOptions& options) {
    add_option(command, farm_group, "--to", options.scheduler,
               "Who spreads the parts: job files for it are written beside the plan (docs/machines.md)",
               one_of(std::vector<std::string>(scheduler_names.begin(), scheduler_names.end())))
        ->required();
    CLI::Option* parts =
        add_option(command, farm_group, "--parts", options.parts,
                   "Parts to make, at most (default: one per chunk of some 60 frames, the least that a part has)", "N",
                   range(1, 1'000'000));
    add_option(command, farm_group, "--frames-per-part", options.frames_per_part,
               "Instead: frames of a part, to the nearest chunk", "N", range(1, 1'000'000'000))
        ->excludes(parts);
    add_flag(command, farm_group, "--pack", options.pack,
             "Copy all inputs into the folder, and the folder into one file, OUT.farm.tar: for machines that do "
             "not see this one's files");
    add_flag(command, farm_group, "--submit", options.submit,
             "Hand the parts that are not made yet to the scheduler, and the join behind them");
}

CLI::App* add_part_command(CLI::App& app, PartOptions& options) {
    CLI::App* command = app.add_subcommand("part", "Make one part of a film that `farm` has planned");
    command->footer(
        "Goes on where a try before was ended, and waits while another one makes the same part. Exit status: 0 the "
        "part is whole; 1 it failed, and another try may do better; 3 this machine, this version or the inputs are "
        "not those of the plan: another try here fails alike.\n"
        "Example: render2mpeg part film.mpg.farm 3");
    add_plan_argument(*command, options.plan);
    CLI::Option* number =
        command->add_option("I", options.number, "Which part, from 1")->check(range(1, 1'000'000).check);
    add_option(*command, farm_run_group, "--frames", options.frames,
               "Instead: all parts that begin with one of these frames", "A-B", contiguous_from)
        ->excludes(number);
    add_threads_option(*command, options.threads);
    add_option(*command, farm_run_group, "--memory", options.memory,
               "Most memory to take, e.g. 8G: refuse what would need more (default: as `farm` was told)", "SIZE",
               memory_from);
    add_flag(*command, farm_run_group, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_join_command(CLI::App& app, JoinOptions& options) {
    CLI::App* command = app.add_subcommand("join", "Put the parts of a film together");
    command->footer(
        "Proves that all parts are whole and of one film, puts them together, decodes the film to see that it holds "
        "what was made, and writes all that one run would have written beside it.\n"
        "Example: render2mpeg join film.mpg.farm");
    add_plan_argument(*command, options.plan);
    add_option(*command, farm_run_group, "--into", options.folder,
               "Write film, heatmaps, statistics, report and images into this folder (default: where `farm` was "
               "told)",
               "DIR");
    add_threads_option(*command, options.threads);
    add_flag(*command, farm_run_group, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_farm_status_command(CLI::App& app, FarmStatusOptions& options) {
    CLI::App* command = app.add_subcommand("farm-status", "Show how far the parts of a film are");
    command->footer("Example: render2mpeg farm-status film.mpg.farm");
    add_plan_argument(*command, options.plan);
    add_flag(*command, farm_run_group, "--left", options.left,
             "Print nothing but the numbers of parts that are not whole, as 1,3-5: for scripts");
    return command;
}

std::vector<std::string> render_words(const std::vector<std::string>& farm) {
    const std::vector<std::string> flags{"--submit", "--pack", "--quiet", "-v", "--verbose"};
    std::vector<std::string> without{"--to", "--parts", "--frames-per-part", "-j", "--threads", "--progress"};
    without.insert(without.end(), flags.begin(), flags.end());
    return changed_command(farm, "render", without, flags, {});
}

FrameRange contiguous_from(const std::string& text) {
    const std::size_t dash = text.find('-');
    if (dash == std::string::npos) throw UsageError(text + ": expected two frames with a dash between, as in 60-119");
    return frames_from(std::string(text).replace(dash, 1, ":"));
}

}  // namespace render2mpeg::app
