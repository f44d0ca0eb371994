#include "app/options/scene_options.h"

#include <cmath>
#include <cstdlib>

#include "app/options/coding_options.h"
#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "core/rational.h"
#include "core/view.h"

namespace render2mpeg::app {

std::string check_exposure(const std::string& text) {
    if (text == "auto") return {};
    char* end = nullptr;
    const double ev = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(ev) || std::abs(ev) > 64)
        throw UsageError("exposure " + text + ": expected `auto` or a number of EV from -64 to 64, e.g. -1.5");
    return {};
}

void add_scene_options(CLI::App& command, RenderOptions& options) {
    command
        .add_option(
            "INPUT", options.input,
            "Scene: .gltf, .glb, an animation file (.json, or a folder with film.json), .blend where Blender is "
            "installed, or any format that Assimp reads (.obj, .ply, .fbx, .dae, .3ds, ...)")
        ->required();
    const std::string scene = "Scene";
    command.add_option("--camera", options.camera, "Camera to look through, by name or index (default: the first)")
        ->type_name("NAME")
        ->group(scene);
    command.add_option("--animation", options.animation, "Animation to play, by name or index (default: all at once)")
        ->type_name("NAME")
        ->group(scene);
    command
        .add_option("--variant", options.variant,
                    "Variant of a glTF file's materials, by name or index (default: none of them)")
        ->type_name("NAME")
        ->group(scene);
    command
        .add_option("--sky", options.sky, "Sky image (EXR, HDR, latitude-longitude), or `none` (default: the scene's)")
        ->type_name("FILE|none")
        ->group(scene);
    command
        .add_option("--light", options.light,
                    "What lights a scene without any light: a `studio` with a floor, an `even` sky, or `none`")
        ->check(CLI::IsMember({"studio", "even", "none"}))
        ->capture_default_str()
        ->group(scene);
    command
        .add_option("--indirect", options.indirect,
                    "How bounced light and the sky are gathered: by `rays` that ask a cache on surfaces, or by "
                    "`lightcuts` through light points")
        ->check(CLI::IsMember({"rays", "lightcuts"}))
        ->capture_default_str()
        ->group("Light");
    command.add_option("--vpls", options.vpls, "Light points that carry indirect light; 0: direct light only")
        ->capture_default_str()
        ->check(CLI::Range(0, 1 << 22))
        ->group("Light");
    command
        .add_option(
            "--caustics", options.caustics,
            "Whether mirrors and solid glass throw light onto other things; `off`: they do not, and light passes "
            "solid glass straight")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str()
        ->group("Light");
}

void add_tolerance_option(CLI::App& command, RenderOptions& options, const std::string& group) {
    command
        .add_option(
            "--tolerance", options.tolerance,
            "Error allowed in a pixel's light. `coupled`: what the film's coding and the eye hide; coupled=K: K times "
            "what they hide at most (default: 0.5), less in pictures that others are predicted from; fixed=P% of its "
            "luminance; `reference`: every light point and 4096 rays a point, slow; `truth`: paths of light instead of "
            "light points, as many "
            "as bring each pixel's standard error to 1% of its luminance, or truth=P%, very slow (default: coupled "
            "for films, fixed=2% for frames)")
        ->type_name("coupled|fixed=P%|reference|truth")
        ->check(checked(tolerance_from, ""))
        ->group(group);
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
        .add_option("--edge-samples", options.edge_samples,
                    "Eye samples of pixels that show an edge (default: 16 for films, and 64 or 256 where the edge "
                    "would show; 64 "
                    "for frames; as many as --samples where that is given)")
        ->check(CLI::Range(1, 256))
        ->group(light);
    command
        .add_option("--exposure-samples", options.exposure_samples,
                    "Samples over the shutter and the lens of each pixel that they blur (default: by quantiser, what "
                    "coding keeps of them; `plan` tells)")
        ->check(CLI::Range(1, 1024))
        ->group(light);
    add_tolerance_option(command, options, light);
    command
        .add_option(
            "--masking", options.masking,
            "What hides errors in coupled films: the picture before, `warped` along motion, or place by place as "
            "decoded, its coding errors included (`quantised`; for films that hardly move)")
        ->check(CLI::IsMember({"warped", "quantised"}))
        ->capture_default_str()
        ->group(light);
    command
        .add_option("--clamp", options.clamp,
                    "Light points too near a surface: `bounded` limits them, `none` does not (bright dots)")
        ->check(CLI::IsMember({"bounded", "none"}))
        ->capture_default_str()
        ->group(light);
    command
        .add_option("--cache", options.cache,
                    "Where light comes from: `on` gathers it at places on surfaces, and keeps it there for other "
                    "pixels and frames while it stays what it is; `off` gathers it for every pixel of every frame; "
                    "`auto` is `on` where only the camera moves, or few things as well, and pictures are large enough; "
                    "`plan` says why")
        ->check(CLI::IsMember({"on", "off", "auto"}))
        ->capture_default_str()
        ->group(light);
}

namespace {

/// Shutter and lens.
void add_exposure_options(CLI::App& command, RenderOptions& options, const std::string& picture) {
    command
        .add_option(
            "--shutter", options.shutter,
            "How long each frame is exposed, in degrees of a frame's time: 180 is half of it, 0 none; and where "
            "the middle of that time lies from the frame's own, in frames, -0.5 to 0.5; and how much later the last "
            "row is exposed than the first, 0 to 1 (default: the animation file's or the .blend's, or 0)")
        ->type_name("ANGLE[:PHASE[:ROLLING]]")
        ->check(checked(shutter_from, ""))
        ->group(picture);
    command
        .add_option("--f-stop", options.f_stop,
                    "Aperture of all cameras: what is out of focus is blurred, more by smaller numbers; `off`: nothing "
                    "is (default: the animation file's or the .blend's, or off)")
        ->type_name("NUMBER|off")
        ->check(checked(f_stop_from, ""))
        ->group(picture);
    command
        .add_option("--focus", options.focus,
                    "What is in focus: a distance along the camera's axis, or the middle of the objects of a name")
        ->type_name("DISTANCE|NAME")
        ->group(picture);
}

}  // namespace

void add_picture_options(CLI::App& command, RenderOptions& options) {
    const std::string picture = "Picture and time";
    command
        .add_option("-s,--size", options.size,
                    "Picture size (default: the animation file's; 640 pixels along the longer side of the camera's "
                    "shape; 512x512 "
                    "where neither says anything)")
        ->type_name("WxH")
        ->check(checked(size_from, ""))
        ->group(picture);
    command
        .add_option("-r,--fps", options.rate,
                    "Pictures per second (default: the animation file's, that of glTF's keys, or 25)")
        ->type_name("23.976|24|25|29.97|30|50|59.94|60")
        ->check(checked(core::frame_rate_from, ""))
        ->group(picture);
    command
        .add_option("--frames", options.frames,
                    "First and last frame, counted from 0, both included (default: the whole film)")
        ->type_name("A:B")
        ->check(checked(frames_from, ""))
        ->group(picture);
    command
        .add_flag("--hold", options.hold,
                  "Frames outside the film are wanted: they hold what its end, or its beginning, shows")
        ->group(picture);
    add_shape_options(command, options.coding);
    command.add_option("--exposure", options.exposure, "EV, or `auto`: one value for the film")
        ->type_name("auto|EV")
        ->check(checked(check_exposure, ""))
        ->capture_default_str()
        ->group(picture);
    add_exposure_options(command, options, picture);
    command
        .add_option("--fog", options.fog,
                    "Fog: off, or how far one sees in it, scene units (default: the animation file's, or off)")
        ->type_name("off|DISTANCE")
        ->check(checked(fog_from, ""))
        ->group(picture);
    command
        .add_option("--glare", options.glare,
                    "What bright light does in an eye: off, static or temporal, and the share of light that is "
                    "scattered, 0 to 0.5 (default: the animation file's, or off)")
        ->type_name("KIND[:STRENGTH]")
        ->check(checked(glare_from, ""))
        ->group(picture);
    command
        .add_option("--view", options.view,
                    "What bright light becomes: neutral, or Blender's standard, filmic (also filmic-high-contrast and "
                    "so on) or agx (default: the animation file's or the .blend's, or neutral)")
        ->type_name("NAME")
        ->check(checked(core::view_from, ""))
        ->group(picture);
}

}  // namespace render2mpeg::app
