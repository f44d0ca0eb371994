#include "app/options.h"

#include <cmath>
#include <cstdlib>

#include "app/coding_options.h"
#include "core/error.h"
#include "core/rational.h"

namespace render2mpeg::app {
namespace {

std::string check_exposure(const std::string& text) {
    if (text == "auto") return {};
    char* end = nullptr;
    const double ev = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(ev) || std::abs(ev) > 64)
        throw core::Error("exposure " + text + ": expected `auto` or a number of EV from -64 to 64, e.g. -1.5");
    return {};
}

/// Options that choose what is seen and lit: `render` and `plan` share them.
void add_scene_options(CLI::App& command, RenderOptions& options) {
    command
        .add_option(
            "INPUT", options.input,
            "Scene: .gltf, .glb, an animation file (.json, or a folder with film.json), or any format that Assimp\n"
            "reads (.obj, .ply, .fbx, .dae, .3ds, ...)")
        ->required();
    const std::string scene = "Scene";
    command.add_option("--camera", options.camera, "Camera to look through, by name or index (default: the first)")
        ->group(scene);
    command.add_option("--animation", options.animation, "Animation to play, by name or index (default: all at once)")
        ->group(scene);
    command
        .add_option("--sky", options.sky, "Sky image (EXR, HDR, latitude-longitude), or `none` (default: the scene's)")
        ->type_name("FILE|none")
        ->group(scene);
    command.add_option("--vpls", options.vpls, "Light points that carry indirect light; 0: direct light only")
        ->check(CLI::Range(0, 1 << 22))
        ->capture_default_str()
        ->group("Light");
}

void add_light_options(CLI::App& command, RenderOptions& options) {
    const std::string light = "Light";
    command
        .add_option("--samples", options.samples,
                    "Eye samples per pixel: edges and textures; light is gathered once per surface")
        ->check(CLI::Range(1, 256))
        ->capture_default_str()
        ->group(light);
    command
        .add_option(
            "--tolerance", options.tolerance,
            "Error allowed in a pixel's light. `coupled`: what the film's coding and the eye hide; coupled=K: K times "
            "what\n"
            "they hide at most; fixed=P% of its luminance; `reference`: every light point, slow (default: coupled for "
            "films,\n"
            "fixed=2% for frames)")
        ->type_name("coupled|fixed=P%|reference")
        ->check(checked(tolerance_from, ""))
        ->group(light);
    command
        .add_option(
            "--masking", options.masking,
            "What hides errors in coupled films: the picture before, `carried` along motion, or place by place as\n"
            "decoded, its coding errors included (`quantised`; for films that hardly move)")
        ->check(CLI::IsMember({"carried", "quantised"}))
        ->capture_default_str()
        ->group(light);
    // For docs/decisions/0008 to be measured again; not for users.
    command.add_option("--error-maps", options.error_maps, "Pictures judged: `references` (I and P) or `intra`")
        ->check(CLI::IsMember({"references", "intra"}))
        ->group("");
    command.add_option("--error-spread", options.error_spread, "A block's error in its pixels: `block` or `pixel`")
        ->check(CLI::IsMember({"block", "pixel"}))
        ->group("");
    command
        .add_option(
            "--stop", options.stop,
            "When light is gathered finely enough: `honest` once the pixel's whole error is reckoned to be within\n"
            "its tolerance, `classic` once every single cluster's is")
        ->check(CLI::IsMember({"honest", "classic"}))
        ->capture_default_str()
        ->group(light);
    command
        .add_option("--clamp", options.clamp,
                    "Light points too near a surface: `bounded` limits them, `none` does not (bright dots)")
        ->check(CLI::IsMember({"bounded", "none"}))
        ->capture_default_str()
        ->group(light);
}

void add_picture_options(CLI::App& command, RenderOptions& options) {
    const std::string picture = "Picture and time";
    command.add_option("--size", options.size, "Picture size (default: the animation file's, or 512x512)")
        ->type_name("WxH")
        ->check(checked(size_from, ""))
        ->group(picture);
    command
        .add_option(
            "--fps", options.rate,
            "Pictures per second: 23.976, 24, 25, 29.97, 30, 50, 59.94 or 60 (default: the animation file's, or 25)")
        ->type_name("R")
        ->check(checked(core::frame_rate_from, ""))
        ->group(picture);
    command
        .add_option("--frames", options.frames,
                    "First and last frame, counted from 0, both included (default: the whole film)")
        ->type_name("A:B")
        ->check(checked(frames_from, ""))
        ->group(picture);
    add_shape_options(command, options.coding);
    command.add_option("--exposure", options.exposure, "EV, or `auto`: one value for the film")
        ->type_name("auto|EV")
        ->check(checked(check_exposure, ""))
        ->capture_default_str()
        ->group(picture);
}

void add_run_options(CLI::App& command, RenderOptions& options) {
    const std::string run = "Run";
    command.add_option("--threads", options.threads, "Threads; 0: one per core. The film's bytes do not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str()
        ->group(run);
    command
        .add_option(
            "--isa", options.isa,
            "Instruction set: sse2, sse4.2, avx, avx2 or avx512 (default: the best there is). Films differ in a few\n"
            "roundings between them")
        ->type_name("LEVEL")
        ->group(run);
    command.add_option("--stats", options.stats, "Write statistics as JSON (docs/stats.md)")
        ->type_name("FILE.json")
        ->group(run);
    command
        .add_option(
            "--audit", options.audit,
            "Gather so many pixels of every frame again, from every light point, and say how well tolerances were\n"
            "kept")
        ->type_name("N")
        ->check(CLI::Range(0, 1 << 20))
        ->capture_default_str()
        ->group(run);
    command
        .add_option("--aov", options.layers, "Write one multilayer OpenEXR per frame into this folder (docs/layers.md)")
        ->type_name("DIR")
        ->group(run);
    command
        .add_option(
            "--heatmap", options.heatmaps,
            "Write a film in false colours beside: what each pixel's light may be off by (`tolerance`), clusters\n"
            "(`cut`), what it may be off by as gathered (`error`), or each macroblock's `quantiser`; may be given "
            "several times")
        ->type_name("SUBJECT OUT.mpg")
        ->group(run);
    command.add_flag("--dry-run", options.dry_run, "Read and check everything, say what would be done, write nothing")
        ->group(run);
    command.add_flag("--quiet", options.quiet, "Print nothing but errors")->group(run);
}

CLI::App* add_encode_command(CLI::App& app, EncodeOptions& options) {
    CLI::App* command = app.add_subcommand("encode", "Encode frames and motion of any renderer");
    command->footer(
        "Motion: OpenEXR files with the number of their frame, as `render --aov` writes them (docs/encode.md).\n"
        "Example: render2mpeg encode shot.%04d.exr -o shot.mpg --motion shot.%04d.exr --exposure 0.5");
    command
        ->add_option("FRAMES", options.input,
                     "A .y4m file (8-bit 4:2:0), or numbered images: frames.%04d.exr (scene-linear) or .png")
        ->required();
    command->add_option("-o,--output", options.output, "Film to write: .mpg, .vob, .ts, .m2v, .mkv or .mp4")
        ->type_name("OUT")
        ->required();
    const std::string picture = "Picture and time", motion = "Motion", run = "Run";
    command
        ->add_option("--fps", options.rate,
                     "Pictures per second: 23.976, 24, 25, 29.97, 30, 50, 59.94 or 60 (default: the Y4M file's, or 25)")
        ->type_name("R")
        ->check(checked(core::frame_rate_from, ""))
        ->group(picture);
    command
        ->add_option("--frames", options.frames,
                     "First and last frame, both included: numbers of the images, or places in the Y4M file from 0\n"
                     "(default: all)")
        ->type_name("A:B")
        ->check(checked(frames_from, ""))
        ->group(picture);
    add_shape_options(*command, options.coding);
    command->add_option("--exposure", options.exposure, "EV for scene-linear frames (default: 0)")
        ->type_name("EV")
        ->check(CLI::Range(-64.0f, 64.0f))
        ->group(picture);
    command->add_option("--motion", options.motion, "Numbered OpenEXR files with the frames' exact motion")
        ->type_name("PATTERN")
        ->group(motion);
    command->add_option("--motion-convention", options.motion_convention, "What their channels mean: blender or nuke")
        ->check(CLI::IsMember({"blender", "nuke"}))
        ->type_name("NAME")
        ->capture_default_str()
        ->group(motion);
    add_coding_options(*command, options.coding);
    command->add_option("--threads", options.threads, "Threads; 0: one per core. The film's bytes do not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str()
        ->group(run);
    command->add_option("--stats", options.stats, "Write statistics as JSON (docs/stats.md)")
        ->type_name("FILE.json")
        ->group(run);
    command->add_flag("--quiet", options.quiet, "Print nothing but errors")->group(run);
    return command;
}

}  // namespace

CommandLine parse(int argc, char** argv) {
    CommandLine line;
    for (int i = 0; i < argc; ++i) line.text += (i == 0 ? "" : " ") + std::string(argv[i]);

    CLI::App app("Renders a 3D animation with global illumination straight into an MPEG-2 file.", "render2mpeg");
    app.set_version_flag("--version", "render2mpeg " RENDER2MPEG_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);

    CLI::App* render = app.add_subcommand("render", "Render a film");
    render->footer(
        "The ending of OUT chooses what is written: .mpg and .vob (MPEG-2 program streams), .ts, .m2v, .mkv, .mp4; "
        ".y4m; or\n"
        "numbered images, e.g. frames.%04d.exr or frames.%04d.png.\n"
        "Example: render2mpeg render animations/cornell -o cornell.mpg --quantiser 6");
    add_scene_options(*render, line.render);
    render->add_option("-o,--output", line.render.output, "File to write; the ending chooses its kind")
        ->type_name("OUT")
        ->required();
    add_picture_options(*render, line.render);
    add_light_options(*render, line.render);
    add_coding_options(*render, line.render.coding);
    add_run_options(*render, line.render);

    const CLI::App* encode = add_encode_command(app, line.encode);
    CLI::App* plan = app.add_subcommand("plan", "Show which passes a scene calls for, and why");
    plan->footer("Example: render2mpeg plan scene.glb --stats stats.json");
    add_scene_options(*plan, line.plan.render);
    plan->add_option("--aov", line.plan.render.layers, "Plan for a render with this option")
        ->type_name("DIR")
        ->group("Run");
    plan->add_option("--stats", line.plan.statistics, "Statistics of a render of this scene: adds what each pass cost")
        ->type_name("FILE.json")
        ->group("Run");

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        line.exit_code = app.exit(error) == 0 ? 0 : 1;
        return line;
    }
    line.command = render->parsed() ? Command::render : encode->parsed() ? Command::encode : Command::plan;
    return line;
}

}  // namespace render2mpeg::app
