#include "app/options/encode_options.h"

#include "app/options/option_text.h"
#include "core/rational.h"
#include "core/view.h"

namespace render2mpeg::app {

namespace {

void add_motion_options(CLI::App& command, EncodeOptions& options) {
    add_option(command, "Motion", "--motion", options.motion,
               "Numbered OpenEXR files with the frames' exact motion; or a motion stream, which other programs write "
               "beside their pictures: fd:N, an open descriptor, or PIPE.motion",
               "PATTERN|fd:N|PIPE.motion");
    add_option(command, "Motion", "--motion-convention", options.motion_convention,
               "What their channels mean: blender or nuke", one_of({"blender", "nuke"}), shown);
}

}  // namespace

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
                     "Film to write: .mpg, .vob, .ts, .m2v, .mkv or .mp4; `-`: standard output")
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
    add_option(*command, run, "-j,--threads", options.threads,
               "Threads; 0: one per core. The film's bytes do not depend on it", range(0, 1024), shown);
    add_option(*command, run, "--stats", options.stats, "Write statistics as JSON (docs/json.md)", "FILE.json");
    add_consent_option(*command, options.overwrite);
    add_flag(*command, run, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_info_command(CLI::App& app, InfoOptions& options) {
    CLI::App* command = app.add_subcommand("info", "Show how the pictures of an MPEG-2 file are coded");
    command->footer(
        "Whose encoder made the file does not matter. Exit status 1 where pictures are damaged (docs/first-film.md).\n"
        "Example: render2mpeg info film.mpg --summary");
    command->add_option("FILE", options.input, "Film in any container, or a bare MPEG-2 video stream")->required();
    command->add_flag("--json", options.json, "Print JSON instead of tables");
    command->add_flag("--summary", options.summary, "Leave out the pictures one by one");
    return command;
}

}  // namespace render2mpeg::app
