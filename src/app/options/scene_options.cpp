#include "app/options/scene_options.h"

#include <cmath>
#include <cstdlib>

#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "core/rational.h"
#include "core/view.h"

namespace render2mpeg::app {
namespace {

std::string check_exposure(const std::string& text) {
    if (text == "auto") return {};
    char* end = nullptr;
    const double ev = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(ev) || std::abs(ev) > 64)
        throw UsageError("exposure " + text + ": expected `auto` or a number of EV from -64 to 64, e.g. -1.5");
    return {};
}

void add_light_options(CLI::App& command, RenderOptions& options) {
    const std::string light = "Light";
    add_option(command, light, "--samples", options.samples,
               "Eye samples per pixel: edges and textures; light is gathered once per surface", range(1, 256), shown);
    add_option(command, light, "--edge-samples", options.edge_samples,
               "Eye samples of pixels that show an edge (default: 16 for films, and 64 or 256 where the edge "
               "would show; 64 "
               "for frames; as many as --samples where that is given)",
               range(1, 256));
    add_option(command, light, "--exposure-samples", options.exposure_samples,
               "Samples over the shutter and the lens of each pixel that they blur (default: by quantiser, what "
               "coding keeps of them; `plan` tells)",
               range(1, 1024));
    add_option(
        command, light, "--tolerance", options.tolerance,
        "Error allowed in a pixel's light. `coupled`: what the film's coding and the eye hide; coupled=K: K times "
        "what they hide at most (default: 0.5), less in pictures that others are predicted from; fixed=P% of its "
        "luminance; `reference`: every light point and 4096 rays a point, slow; `truth`: paths of light instead of "
        "light points, as many "
        "as bring each pixel's standard error to 1% of its luminance, or truth=P%, very slow (default: coupled "
        "for films, fixed=2% for frames)",
        "coupled|fixed=P%|reference|truth", tolerance_from);
    add_option(command, light, "--masking", options.masking,
               "What hides errors in coupled films: the picture before, `warped` along motion, or place by place as "
               "decoded, its coding errors included (`quantised`; for films that hardly move)",
               one_of({"warped", "quantised"}), shown);
    add_option(command, light, "--clamp", options.clamp,
               "Light points too near a surface: `bounded` limits them, `none` does not (bright dots)",
               one_of({"bounded", "none"}), shown);
    add_option(
        command, light, "--cache", options.cache,
        "Where light comes from: `on` gathers it at places on surfaces, and keeps it there for other "
        "pixels and frames, where it follows light that changes; `off` gathers it for every pixel of every frame; "
        "`auto` is `on` wherever that pays: with `--indirect lightcuts` only where nothing but the camera "
        "moves, and pictures are large enough; `plan` says why",
        one_of({"on", "off", "auto"}), shown);
}

/// Shutter and lens.
void add_exposure_options(CLI::App& command, RenderOptions& options, const std::string& picture) {
    add_option(command, picture, "--shutter", options.shutter,
               "How long each frame is exposed, in degrees of a frame's time: 180 is half of it, 0 none; and where "
               "the middle of that time lies from the frame's own, in frames, -0.5 to 0.5; and how much later the last "
               "row is exposed than the first, 0 to 1 (default: the animation file's or the .blend's, or 0)",
               "ANGLE[:PHASE[:ROLLING]]", shutter_from);
    add_option(command, picture, "--f-stop", options.f_stop,
               "Aperture of all cameras: what is out of focus is blurred, more by smaller numbers; `off`: nothing "
               "is (default: the animation file's or the .blend's, or off)",
               "NUMBER|off", f_stop_from);
    add_option(command, picture, "--focus", options.focus,
               "What is in focus: a distance along the camera's axis, or the middle of the objects of a name",
               "DISTANCE|NAME");
}

void add_picture_options(CLI::App& command, RenderOptions& options) {
    const std::string picture = "Picture and time";
    add_option(command, picture, "-s,--size", options.size,
               "Picture size (default: the animation file's; 640 pixels along the longer side of the camera's "
               "shape; 512x512 "
               "where neither says anything)",
               "WxH", size_from);
    add_option(command, picture, "-r,--fps", options.rate,
               "Pictures per second (default: the animation file's, that of glTF's keys, or 25)",
               "23.976|24|25|29.97|30|50|59.94|60", core::frame_rate_from);
    add_option(command, picture, "--frames", options.frames,
               "First and last frame, counted from 0, both included (default: the whole film)", "A:B", frames_from);
    add_flag(command, picture, "--hold", options.hold,
             "Frames outside the film are wanted: they hold what its end, or its beginning, shows");
    add_shape_options(command, options.coding);
    add_option(command, picture, "--exposure", options.exposure, "EV, or `auto`: one value for the film", "auto|EV",
               check_exposure, shown);
    add_exposure_options(command, options, picture);
    add_option(command, picture, "--fog", options.fog,
               "Fog: off, or how far one sees in it, scene units (default: the animation file's, or off)",
               "off|DISTANCE", fog_from);
    add_option(command, picture, "--glare", options.glare,
               "What bright light does in an eye: off, static or temporal, and the share of light that is "
               "scattered, 0 to 0.5 (default: the animation file's, or off)",
               "KIND[:STRENGTH]", glare_from);
    add_option(command, picture, "--view", options.view,
               "What bright light becomes: neutral, or Blender's standard, filmic (also filmic-high-contrast and "
               "so on) or agx (default: the animation file's or the .blend's, or neutral)",
               "NAME", core::view_from);
    add_option(command, picture, "--transparent", options.transparent,
               "Whether the camera does not see the sky, which shines all the same: frames have alpha, films black "
               "there (default: the animation file's or the .blend's, or off)",
               one_of({"on", "off"}));
}

}  // namespace

void add_scene_options(CLI::App& command, RenderOptions& options) {
    command
        .add_option(
            "INPUT", options.input,
            "Scene: .gltf, .glb, an animation file (.json, or a folder with film.json), .blend where Blender is "
            "installed, or any format that Assimp reads (.obj, .ply, .fbx, .dae, .3ds, ...)")
        ->required();
    const std::string scene = "Scene";
    add_option(command, scene, "--camera", options.camera,
               "Camera to look through, by name or index (default: the first)", "NAME");
    add_option(command, scene, "--animation", options.animation,
               "Animation to play, by name or index (default: all at once)", "NAME");
    add_option(command, scene, "--variant", options.variant,
               "Variant of a glTF file's materials, by name or index (default: none of them)", "NAME");
    add_option(command, scene, "--sky", options.sky,
               "Sky image (EXR, HDR, latitude-longitude), or `none` (default: the scene's)", "FILE|none");
    add_option(command, scene, "--light", options.light,
               "What lights a scene without any light: a `studio` with a floor, an `even` sky, or `none`",
               one_of({"studio", "even", "none"}), shown);
    add_option(command, "Light", "--indirect", options.indirect,
               "How bounced light and the sky are gathered: by `rays` that ask a cache on surfaces, or by "
               "`lightcuts` through light points",
               one_of({"rays", "lightcuts"}), shown);
    add_option(command, "Light", "--vpls", options.vpls, "Light points that carry indirect light; 0: direct light only",
               shown, range(0, 1 << 22));
    add_option(command, "Light", "--caustics", options.caustics,
               "Whether mirrors and solid glass throw light onto other things; `off`: they do not, and light passes "
               "solid glass straight",
               one_of({"on", "off"}), shown);
}

void add_film_options(CLI::App& command, RenderOptions& options) {
    add_picture_options(command, options);
    add_light_options(command, options);
    add_coding_options(command, options.coding);
}

void add_effort_option(CLI::App& command, RenderOptions& options) {
    add_option(command, "Light", "--effort", options.effort,
               "All settings of light by one name: `draft`, as --preview but in the film's size, `low`, `default` or "
               "`high`; other options win over it; `cost` tells what each takes and loses",
               one_of({"draft", "low", "default", "high"}));
}

}  // namespace render2mpeg::app
