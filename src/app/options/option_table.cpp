#include "app/options/option_table.h"

#include <fmt/ranges.h>

#include <type_traits>

#include "app/options/film.h"
#include "app/options/option_text.h"
#include "app/options/shape.h"
#include "app/options/usage_error.h"
#include "app/system/memory_limit.h"
#include "core/isa.h"
#include "core/rational.h"
#include "core/view.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

using Rows = std::vector<OptionRow>;
constexpr const char *scene = "Scene", *picture = "Picture and time", *light = "Light", *coding = "Coding",
                     *sound = "Sound and labels", *run = "Run", *tried = "What is tried", *farm = "Farm",
                     *target = "What is to be reached (one of these)";

template <auto read>
void reads(const std::string& text, const std::string& /*option*/) {
    read(text);
}
template <auto read, class Value>
Parser into(Value& member) {
    return [&member](const std::string& text, const std::string& /*option*/) { member = read(text); };
}
Parser into_bits(std::optional<std::int64_t>& member) {
    return [&member](const std::string& text, const std::string& option) { member = bits_from(text, option); };
}

template <class Number>
constexpr Range range(Number low, Number high) {
    return {double(low), double(high), std::is_integral_v<Number>};
}

Rows file_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"INPUT", "", &o.input,
         "Scene: .gltf, .glb, an animation file (.json, or a folder with film.json), .blend where Blender is "
         "installed, or any format that Assimp reads (.obj, .ply, .fbx, .dae, .3ds, ...)",
         Required()},
        {"FRAMES", "", &o.input,
         "A .y4m file, numbered images: frames.%04d.exr (scene-linear), .png, .tif or .jpg; or `-`: Y4M from "
         "standard input, as another program makes it",
         Required()},
        {"FILE", "", &line.info.input, "Film in any container, or a bare MPEG-2 video stream", Required()},
        {"PLAN", "", &line.part.plan, "The folder that `farm` wrote, e.g. film.mpg.farm, or its plan.json", Required()},
        {"I", "", &line.part.number, "Which part, from 1", "INT", range(1, 1'000'000), Required()},
        {"-o,--output@render", "", &o.output, "File to write; the ending chooses its kind; `-`: standard output", "OUT",
         Required(), Idle::always},
        {"-o,--output@farm", "", &o.output, "File to write; the ending chooses its kind", "OUT", Required()},
        {"-o,--output@watch", "", &o.output, "Write each draft to this file instead of showing it", "OUT"},
        {"-o,--output@plan", "", &o.output, "Only its ending counts (default: a film)", "OUT"},
        {"-o,--output@tune", "", &o.output, "Film to make; with --dry-run not needed", "OUT"},
        {"-o,--output@encode", "", &o.output,
         "Film to write: .mpg, .vob, .ts, .m2v, .mkv, .webm, .mp4 or .mov; `-`: standard output", "OUT", Required()},
        {"--as", "", &o.as,
         "With -o -: what goes to standard output, picture by picture as it is made: a transport stream, bare MPEG-2, "
         "or uncompressed pictures (default: ts)",
         Words{"ts|m2v|y4m"}},
        {"--as@encode", "", &o.as, "With -o -: a transport stream, or bare MPEG-2 (default: ts)", Words{"ts|m2v"}},
        {"--json@info", "", &line.info.json, "Print JSON instead of tables"},
        {"--summary", "", &line.info.summary, "Leave out the pictures one by one"},
    };
}

Rows scene_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"--camera", scene, &o.camera, "Camera to look through, by name or index (default: the first)", "NAME"},
        {"--projection", scene, &o.projection,
         "Panoramas of all cameras: all around, or half of it (default: the scene's)", Words{"equirectangular|vr180"}},
        {"--stereo", scene, &o.stereo, "Pictures for two eyes, each of --size (default: the scene's)",
         Words{"side-by-side|top-bottom|none"}},
        {"--projection@encode", picture, &line.encode.projection, "Frames are panoramas",
         Words{"equirectangular|vr180"}},
        {"--stereo@encode", picture, &line.encode.stereo, "Frames hold both eyes'", Words{"side-by-side|top-bottom"}},
        {"--animation", scene, &o.animation, "Animation to play, by name or index (default: all at once)", "NAME"},
        {"--variant", scene, &o.variant, "Variant of a glTF file's materials, by name or index (default: none of them)",
         "NAME"},
        {"--sky", scene, &o.sky, "Sky image (EXR, HDR, latitude-longitude), or `none` (default: the scene's)",
         "FILE|none"},
        {"--light", scene, &o.light,
         "What lights a scene without any light: a `studio` with a floor, an `even` sky, or `none`",
         Words{"studio|even|none"}, Shown()},
        {"--indirect", light, &o.indirect,
         "How bounced light and the sky are gathered: by `rays` that ask a cache on surfaces, or by `lightcuts` "
         "through light points",
         Words{"rays|lightcuts"}, Shown()},
        {"--vpls", light, &o.vpls,
         "Light points that carry indirect light by `--indirect lightcuts`; 0: direct light only", Shown(),
         range(0, 1 << 22), Idle::without_points},
        {"--caustics", light, &o.caustics,
         "Whether mirrors and solid glass throw light onto other things; `off`: they do not, and light passes solid "
         "glass straight",
         Words{"on|off"}, Shown()},
        {"--limits", light, &o.limits,
         "Whether a .blend's limit of transparent bounces holds, behind which Cycles is black: `blender`, or `none`",
         Words{"blender|none"}, Shown()},
    };
}

Rows time_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"--preview", picture, &o.preview,
         "A draft of every frame, in minutes: half the size unless --size is given, rough light, coded fast; timing, "
         "framing, light and cuts are the film's (docs/pictures.md)"},
        {"-s,--size", picture, into<size_from>(o.size),
         "Picture size (default: the animation file's; 640 pixels along the longer side of the camera's shape; 512x512 "
         "where neither says anything)",
         "WxH"},
        {"-r,--fps", picture, into<core::frame_rate_from>(o.rate),
         "Pictures per second; MPEG-2 has these (default: the scene's own, or 25)",
         "23.976|24|25|29.97|30|50|59.94|60"},
        {"-r,--fps@encode", picture, into<core::frame_rate_from>(o.rate),
         "Pictures per second; MPEG-2 has these (default: the Y4M file's, or 25)", "23.976|24|25|29.97|30|50|59.94|60"},
        {"--frames", picture, into<frames_from>(o.frames),
         "First and last frame, counted from 0, both included (default: the whole film)", "A:B"},
        {"--frames@encode", picture, into<frames_from>(o.frames),
         "First and last frame, both included: numbers of the images, or places in the Y4M file from 0 (default: all)",
         "A:B"},
        {"--hold", picture, &o.hold,
         "Frames outside the film are wanted: they hold what its end, or its beginning, shows", Idle::always},
        {"--display-aspect", picture, into<core::ratio_from>(o.coding.display_aspect),
         "Shape of the whole picture as shown, e.g. 16:9 (default: as the animation file or the frames say, else of "
         "square pixels)",
         "W:H"},
        {"--pixel-aspect", picture, into<core::ratio_from>(o.coding.pixel_aspect),
         "Shape of a pixel instead, e.g. 16:15", "W:H", NotWith{"--display-aspect"}},
    };
}

Rows picture_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"--exposure", picture, into<exposure_from>(o.exposure), "EV, or `auto`: one value for the film", "auto|EV",
         ShownAs{"auto"}, Idle::unexposed},
        {"--exposure@encode", picture, &line.encode.exposure, "EV for scene-linear frames (default: 0)",
         range(-64.0f, 64.0f)},
        {"--shutter", picture, into<shutter_from>(o.shutter),
         "How long each frame is exposed, in degrees of a frame's time: 180 is half of it, 0 none; and where the "
         "middle of that time lies from the frame's own, in frames, -0.5 to 0.5; and how much later the last row is "
         "exposed than the first, 0 to 1 (default: the animation file's or the .blend's, or 0)",
         "ANGLE[:PHASE[:ROLLING]]"},
        {"--f-stop", picture, into<f_stop_from>(o.f_stop),
         "Aperture of all cameras: what is out of focus is blurred, more by smaller numbers; `off`: nothing is "
         "(default: the animation file's or the .blend's, or off)",
         "NUMBER|off"},
        {"--focus", picture, &o.focus,
         "What is in focus: a distance along the camera's axis, or the middle of the objects of a name",
         "DISTANCE|NAME"},
        {"--fog", picture, into<fog_from>(o.fog),
         "Fog: off, or how far one sees in it, scene units (default: the animation file's, or off)", "off|DISTANCE"},
        {"--glare", picture, into<glare_from>(o.glare),
         "What bright light does in an eye: off, static or temporal, and the share of light that is scattered, 0 to "
         "0.5 (default: the animation file's, or off)",
         "KIND[:STRENGTH]", Idle::undeveloped},
        {"--view", picture, into<core::view_from>(o.view),
         "What bright light becomes: `neutral`; as in Blender, also `filmic-high-contrast` and so on; or high dynamic "
         "range, pq or hlg in BT.2020 (default: the animation file's or the .blend's, or neutral)",
         "neutral|standard|filmic|agx|pq|hlg", Idle::undeveloped},
        {"--view@encode", picture, into<core::view_from>(o.view),
         "As for render; PNG frames keep their code values (default: neutral)", "neutral|standard|filmic|agx|pq|hlg"},
        {"--grain", picture, into<grain_from>(o.grain),
         "Grain of a film of this speed, 50 to 6400; AV1's decoders add it (default: the animation file's, or 0)",
         "ISO", Idle::undeveloped},
        {"--grain@encode", picture, into<grain_from>(o.grain), "As for render (default: 0, none)", "ISO"},
        {"--peak", picture, &o.peak, "White of films in pq, cd/m2 (default: 1000)",
         range(static_cast<int>(core::least_peak), static_cast<int>(core::largest_peak)), Idle::undeveloped},
        {"--peak@encode", picture, &o.peak, "As for render",
         range(static_cast<int>(core::least_peak), static_cast<int>(core::largest_peak))},
        {"--transparent", picture, &o.transparent,
         "Whether the camera does not see the sky, which shines all the same: frames, .webm and ProRes 4444 have "
         "alpha, other films black there "
         "(default: the animation file's or the .blend's, or off)",
         Words{"on|off"}},
        {"--transparent@encode", picture, &line.encode.transparent,
         "Whether .webm, .gif and ProRes 4444 keep the frames' alpha (default: on)", Words{"on|off"}},
        {"--motion", "Motion", &line.encode.motion,
         "Numbered OpenEXR files with the frames' exact motion; or a motion stream, which other programs write beside "
         "their pictures: fd:N, an open descriptor, or PIPE.motion",
         "PATTERN|fd:N|PIPE.motion"},
        {"--motion-convention", "Motion", &line.encode.motion_convention, "What their channels mean: blender or nuke",
         Words{"blender|nuke"}, Shown(), Idle::without_vectors},
    };
}

Rows light_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"--effort", light, &o.effort,
         "All settings of light by one name: `draft`, as --preview but in the film's size, `low`, `default` or `high`; "
         "other options win over it; `cost` tells what each takes and loses",
         Words{"draft|low|default|high"}},
        {"--samples", light, &o.samples,
         "Eye samples per pixel: edges and textures; light is gathered once per surface", range(1, 256), Shown(),
         Idle::traced},
        {"--edge-samples", light, &o.edge_samples,
         "Eye samples of pixels that show an edge (default: 16 for films, and 64 or 256 where the edge would show; 64 "
         "for frames; as many as --samples where that is given)",
         range(1, 256), Idle::traced},
        {"--exposure-samples", light, &o.exposure_samples,
         "Samples over the shutter and the lens of each pixel that they blur (default: by quantiser, what coding keeps "
         "of them; `plan` tells)",
         range(1, 1024)},
        {"--tolerance", light, into<tolerance_from>(o.tolerance),
         "Error allowed in a pixel's light. `coupled`: of what the film's coding and the eye hide as much as --loss "
         "allows; coupled=K: K times that, less in pictures that others are predicted from; fixed=P% of its "
         "luminance; `reference`: every light point and 4096 rays a point, slow; `truth`: paths of light instead of "
         "light points, as many as bring each pixel's standard error to 1% of its luminance, or truth=P%, very slow "
         "(default: coupled for films, fixed=1% for masters, fixed=2% for frames)",
         "coupled|fixed=P%|reference|truth"},
        {"--loss", light, &o.loss,
         "PSNR-Y in dB that intra pictures may lose by the noise of their light: expected of a rough look at each "
         "chunk, "
         "then measured in each of them (docs/model/tolerance.md); lower is finer and slower",
         range(0.01, 6.0), ShownAs{"0.2"}, Idle::uncoupled},
        {"--masking", light, &o.masking,
         "What hides errors in coupled films: the picture before, `warped` along motion, or place by place as decoded, "
         "its coding errors included (`quantised`; for films that hardly move)",
         Words{"warped|quantised"}, Shown(), Idle::uncoupled},
        {"--clamp", light, &o.clamp,
         "Light points too near a surface: `bounded` limits them, `none` does not (bright dots)", Words{"bounded|none"},
         Shown(), Idle::traced},
        {"--cache", light, &o.cache,
         "Where light comes from: `on` gathers it at places on surfaces, and keeps it there for other pixels and "
         "frames, where it follows light that changes; `off` gathers it for every pixel of every frame; `auto` is `on` "
         "wherever that pays: with `--indirect lightcuts` only where nothing but the camera moves, and pictures are "
         "large enough; `plan` says why",
         Words{"on|off|auto"}, Shown(), Idle::traced},
    };
}

Rows coding_rows(CommandLine& line) {
    CodingOptions& o = line.render.coding;
    static const std::string codecs = words_of_codecs() + "|h265", gop = std::to_string(usual_gop);
    static const std::string presets = fmt::format("{}", fmt::join(preset_names(), "|"));
    return {
        {"--for", coding, into<preset_from>(o.preset),
         "Where the film goes: dvd-ntsc, dvd-pal or atsc. Sets size, rate, shape, GOPs, rates and buffer "
         "(docs/coding.md); options that contradict are refused",
         Words{presets.c_str()}},
        {"-q,--quantiser", coding, &o.quantiser,
         "quantiser_scale_code of P pictures: 1 is the finest, 31 the coarsest; what many pictures follow from\nis a "
         "little finer, B pictures are coarser. Other codecs code to about the same quality",
         range(1, 31), ShownAs{"4"}, Idle::uncoded},
        {"--codec", coding, into<codec_from>(o.codec),
         "mpeg2, h264, hevc, av1, vp9 (default: h264 in .mp4, .mov, .mkv, vp9 in .webm, else mpeg2); for editors "
         "prores, dnxhr, ffv1 ...",
         "CODEC", Words{codecs.c_str()}, Idle::uncoded},
        {"--level", coding, into<level_from>(o.level),
         "Level of H.264 or AV1 that the film keeps to in size, pictures per second and references, e.g. 4.1 (default: "
         "the lowest)",
         "LEVEL", Idle::uncoded},
        {"--crf", coding, &o.crf,
         "Instead of --quantiser: QP of P pictures in the codec's own scale, 1 to 51 in H.264 and HEVC, to 63 in AV1; "
         "26, 26 and 33 are like quantiser 4",
         "QP", range(1, 63), Idle::uncoded},
        {"--quality", coding, &o.quality,
         "Instead: quality from 0 to 100, coarser where motion hides it; 100 is quantiser 1, 20 less doubles it",
         range(0.0, 100.0), Idle::uncoded},
        {"-b,--bitrate", coding, into_bits(o.bitrate),
         "Instead: bits per second of pictures, on average, e.g. 6M or 900k", "RATE", Idle::uncoded},
        {"--cbr", coding, &o.constant_rate, "With --bitrate: at every time, by stuffing where need be", Idle::uncoded},
        {"--maxrate", coding, into_bits(o.maxrate),
         "Bits per second that pictures reach a decoder with at most (default: the level's)", "RATE", Idle::uncoded},
        {"--vbv", coding, into_bits(o.vbv), "Bits that a decoder's buffer holds (default: the most the level allows)",
         "BITS", Idle::uncoded},
        {"--passes", coding, &o.passes,
         "With --bitrate: 2 looks at the whole film first, cheaply, and spends bits where they are needed; 1 does not "
         "(default: 2)",
         range(1, 2), Idle::uncoded},
        {"--gop", coding, &o.gop, "Pictures per closed group of pictures; with --for, its world's where not given",
         range(1, 1000), ShownAs{gop.c_str()}, Idle::uncoded},
        {"--b-pictures", coding, &o.b_pictures,
         "Most B pictures in a row, fewer where motion is uneven; with --for, its world's where not given", range(0, 3),
         ShownAs{"3"}, Idle::uncoded},
        {"--tune", coding, &o.tune,
         "What is kept: `psnr`, all detail alike; `perceptual`, what the eye sees (default: for H.264 and HEVC)",
         Words{"psnr|perceptual"}, Idle::uncoded},
        {"--encoder", coding, &o.encoder, "How much is tried: `fast`, or `quality` for fewer bits",
         Words{"fast|quality"}, Shown(), Idle::uncoded},
        {"--keyframes", coding, &o.keyframes,
         "Frames that begin a group of pictures whatever is seen: 0,48,96, or a file with their numbers", "LIST|FILE",
         reads<keyframes_from>, Idle::uncoded},
    };
}

Rows product_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"--audio", sound, &o.coding.audio,
         "Sound of the film: whatever FFmpeg reads, or `none` (default: the scene's). MPEG audio layer II in .mpg, "
         ".vob and .ts, AC-3 with --for, AAC in .mkv, .mp4 and .mov, Opus in .webm; it ends with the film",
         "FILE|none", Idle::uncoded},
        {"--audio-offset", sound, &o.coding.audio_offset,
         "Seconds after frame 0 at which the sound begins; below 0 its beginning is cut off", range(-1e5, 1e5), Shown(),
         Idle::uncoded},
        {"--title", sound, &o.coding.title, "Title of the film: .mp4, .mov, .mkv, .webm, .ts", "TEXT", Idle::uncoded},
        {"--timecode", sound, &o.coding.timecode,
         "Timecode of the first picture (.mp4, .mov, .mkv, .webm; MPEG-2); `;` before FF: drop-frame", "HH:MM:SS:FF",
         Idle::uncoded},
        {"--stats", run, &o.stats, "Write statistics as JSON (docs/json.md)", "FILE.json", Idle::always},
        {"--report", run, &o.report,
         "Write a page about the render, with plots, for any browser, and its figures as JSON beside it "
         "(docs/first-film.md)",
         "FILE.html", Idle::always},
        {"--report@trial", run, &line.trial.report,
         "Write a page with plots for any browser, and its figures beside it", "FILE.html"},
        {"--json@trial", run, &line.trial.json, "Write all figures as JSON", "FILE.json"},
        {"--audit", run, &o.audit,
         "Gather so many pixels of every frame again, by reference light, and find their true light by paths: say how "
         "well tolerances were kept, and how far the picture is off by which cause",
         range(0, 1 << 20), Shown()},
        {"--audit@plan", run, &o.audit, "Pixels of every frame that would be gathered again", range(0, 1 << 20)},
        {"--last-frame", run, &o.last_frame,
         "Show the frame lit last in this picture, in place of the one before, once a second", "FILE.png"},
        {"--aov", run, &o.layers, "Write one multilayer OpenEXR per frame into this folder (docs/pictures.md)", "DIR"},
        {"--aov@plan", run, &o.layers, "Folder of multilayer OpenEXR files", "DIR"},
        {"--also", run, &line.also,
         "Write another film of the same light, in a view of its own (--view), by a codec or as its ending says, HEVC "
         "for pq and hlg: one for the web, one for editors, one of high dynamic range; may be given several times",
         TwoWords(), "VIEW[:CODEC] FILE", Idle::always},
        {"--heatmap", run, &line.heatmaps,
         "Write a film in false colours beside: what each pixel's light may be off by (`tolerance`), clusters (`cut`), "
         "the standard error of its light (`error`), each macroblock's `quantiser`, or, where `--cache` keeps light, "
         "how many `records` lie in each pixel, the `age` of its light in frames, and its `reuse`, the share of its "
         "points that it was not gathered for; may be given several times",
         TwoWords(), "tolerance|cut|error|quantiser|records|age|reuse OUT.mpg", Idle::always},
        {"--light-cache", run, &o.light_cache,
         "Begin with the light that earlier runs of the same frames found, and add the light of this one: with another "
         "quantiser, bit rate or codec light takes a third of the time. For light that never changes; made where it is "
         "missing (docs/choosing.md)",
         "FILE"},
        {"--player", run, &o.player, "Player to start: ffplay, mpv, or a program that reads bare MPEG-2", "PROGRAM"},
        {"--live", run, &o.live,
         "Draw what lines of JSON on standard input ask for, and send pictures to standard output (docs/pictures.md)",
         NotWith{"--output"}, NotWith{"--player"}},
    };
}

Rows run_rows(CommandLine& line) {
    RenderOptions& o = line.render;
    return {
        {"-j,--threads", run, &o.threads, "Threads; 0: one per core. The film's bytes do not depend on it",
         range(0, 1024), Shown(), Idle::always},
        {"--isa", run, into<core::isa_from>(o.isa),
         "Instruction set (default: the best there is). Films differ in a few roundings between them",
         "sse2|sse4.2|avx|avx2|avx512", Idle::always},
        {"--memory", run, into<memory_from>(o.memory),
         "Most memory to take, e.g. 8G: refuse what would need more before it is begun, and never swap (default: no "
         "limit)",
         "SIZE", Idle::always},
        {"--memory@part", run, into<memory_from>(o.memory),
         "Most memory to take, e.g. 8G: refuse what would need more (default: as `farm` was told)", "SIZE"},
        {"--chunks-at-once", run, &o.chunks_at_once,
         "Chunks of some 60 frames that are made beside each other, each by a thread or more, where one frame cannot "
         "keep all cores busy (default: one for 4 threads, as memory allows; docs/machines.md). The film's bytes do "
         "not depend on it",
         range(1, 1024), Idle::always},
        {"--resume", run, &o.resume,
         "Go on where a run of the same film was interrupted or killed, after its last whole chunk: the same bytes as "
         "of one run. Begins the film where nothing was left of it (docs/first-film.md)",
         Idle::always},
        {"--dry-run", run, &o.dry_run,
         "Read and check everything, say what would be done and what it would take, write nothing", Idle::always},
        {"--dry-run@tune", run, &o.dry_run, "Render nothing in the end: print the command that would do it"},
        {"--within", run, into<within_from>(o.within),
         "Light a few frames for so long, about, to tell what the film will take; 0: light none", "TIME",
         ShownAs{"10s"}, Idle::always},
        {"-y,--overwrite", run, &o.overwrite,
         "Replace a film that is there, and make folders that are missing; without it both are refused", Idle::always},
        {"--quiet", run, &o.quiet, "Print nothing but errors", Idle::always},
        {"--quiet@plan", run, &o.quiet, "Show no progress"},
        {"-v,--verbose", run, &o.verbose, "Also say what runs and why, and what each chunk came to", NotWith{"--quiet"},
         Idle::always},
        {"--progress", run, &line.progress,
         "How far it is: `line`, for people; `minute`, a line a minute, for logs; `json`, a line for programs at every "
         "step; `openjd`, as OpenJD reads it; or `none`",
         Words{"line|minute|json|openjd|none"}, Shown(), Idle::always},
    };
}

Rows trial_rows(CommandLine& line) {
    TrialOptions& o = line.trial;
    return {
        {"--sample@cost", tried, into<sample_from>(o.sample),
         "Windows spread over the film, by consecutive frames of each; the last frame of each window is also lit as "
         "the reference (default: as --within allows, at most 2x3)",
         "WINDOWSxFRAMES"},
        {"--within@cost", tried, into<time_in_seconds>(o.within),
         "Choose a sample that takes about so long, where --sample does not", "TIME", ShownAs{"1m"}},
        {"--tolerances", tried, into<percents_from>(o.tolerances), "Fixed tolerances, per cent of a pixel's luminance",
         "P,P,...", ShownAs{"16,8,4,2,1"}},
        {"--sample@compare", tried, into<sample_from>(o.sample),
         "Windows spread over the film, by consecutive frames of each; better whole GOPs", "WINDOWSxFRAMES",
         ShownAs{"1x15"}},
        {"--references@compare", tried, &o.references,
         "Frames of each window that are also lit as the reference: they tell what light adds to the errors of all "
         "frames",
         range(1, 1000), ShownAs{"4"}},
        {"--quantisers", tried, into<quantisers_from>(o.quantisers), "Quantisers to code with, two or more", "Q,Q,...",
         ShownAs{"2,4,8,16"}},
        {"--beside", tried, &o.beside, "Another way: `cycles`, denoised, of a .blend, in small", Words{"cycles"}},
        {"--blender", tried, &o.blender,
         "Blender of --beside cycles, or a Python whose module bpy it is; it exports your film, too (default: that of "
         "the PATH)",
         "PROGRAM"},
        {"--sample@tune", tried, into<sample_from>(o.sample),
         "Windows spread over the film, by consecutive frames of each (default: an eighth of the film, at most 2x15; "
         "with --max-time 2x3)",
         "WINDOWSxFRAMES"},
        {"--references@tune", tried, &o.references,
         "Frames of each window that are also lit as the reference, which is dear: they tell what light adds to the "
         "errors of all frames. 0: quality is told against the pictures as they were lit (default: 1; with "
         "--target-bitrate and --max-size 0)",
         range(0, 1000)},
        {"--target-psnr", target, &o.psnr,
         "PSNR-Y in dB of the decoded pictures, to 0.1 dB on the sample: finds --quality", range(1.0, 99.0)},
        {"--target-ssim", target, &o.ssim, "Their SSIM, to 0.002 on the sample: finds --quality", range(0.01, 0.9999)},
        {"--of", target, &o.of, "Whose PSNR or SSIM that is: the whole film's, or that of its worst-tenth of pictures",
         Words{"film|worst-tenth"}, Shown()},
        {"--target-bitrate", target, into_bits(o.bitrate),
         "Bits per second of pictures, to 2 %: --bitrate in two passes, and what quality that is", "RATE"},
        {"--max-size", target, into<size_in_bytes>(o.size), "Bytes of the file at most, e.g. 700M: likewise", "SIZE"},
        {"--max-time", target, into<time_in_seconds>(o.time),
         "Time on the clock at most, e.g. 2h or 90m: loosens --tolerance and --samples, and with `--indirect "
         "lightcuts` --vpls, as far as needed",
         "TIME"},
    };
}

Rows farm_rows(CommandLine& line) {
    static const std::string schedulers = fmt::format("{}", fmt::join(scheduler_names, "|"));
    return {
        {"--to", farm, &line.farm.scheduler,
         "Who spreads the parts: job files for it are written beside the plan (docs/machines.md)",
         Words{schedulers.c_str()}, Required()},
        {"--parts", farm, &line.farm.parts,
         "Parts to make, at most (default: one per chunk of some 60 frames, the least that a part has)",
         range(1, 1'000'000)},
        {"--frames-per-part", farm, &line.farm.frames_per_part, "Instead: frames of a part on average",
         range(1, 1'000'000'000), NotWith{"--parts"}},
        {"--pack", farm, &line.farm.pack,
         "Copy all inputs into the folder, and the folder into one file, OUT.farm.tar: for machines that do not see "
         "this one's files"},
        {"--submit", farm, &line.farm.submit,
         "Hand the parts that are not made yet to the scheduler, and the join behind them"},
        {"--into@part", run, &line.part.pieces,
         "Write each finished chunk into this folder, too, as a file with checksums, from which `join --from` takes "
         "it: for machines that share no folder. Needs no locks; chunks that lie there are not made again",
         "DIR"},
        {"--after-chunk", run, into<command_from>(line.part.after_chunk),
         "Run this after each chunk's file, e.g. 'rclone copy {} remote:film/', with the file's name for {} or behind: "
         "no shell reads it. What fails is tried again, at the end thrice; then the exit status is 1",
         "COMMAND", With{"--into"}},
        {"--from", run, &line.part.pieces,
         "Take chunks that `part --into` wrote from this folder and those in it, in any order", "DIR"},
        {"--into", run, &line.part.folder,
         "Write film, heatmaps, statistics, report and images into this folder (default: where `farm` was told)",
         "DIR"},
        {"--price", farm, into<price_from>(line.render.hire.price),
         "What an hour of a core or machine costs, in any currency: tells what the film does", "0.04/core-hour"},
        {"--machines", farm, &line.render.hire.machines, "Machines of a farm: tells how long it takes there",
         range(1, 100'000)},
        {"--cores", farm, &line.render.hire.cores, "Cores of each machine (default: this one's)", range(1, 1024)},
        {"--price@farm-status", run, into<price_from>(line.part.price),
         "What an hour of a core costs, in any currency: tells what was spent, and what is left", "0.04/core-hour"},
        {"--left", run, &line.part.left,
         "Print nothing but the numbers of parts that are not whole, as 1,3-5: for scripts"},
    };
}

}  // namespace

std::vector<OptionRow> option_rows(CommandLine& line) {
    Rows all;
    for (const auto rows : {file_rows, scene_rows, time_rows, picture_rows, light_rows, coding_rows, product_rows,
                            run_rows, trial_rows, farm_rows})
        for (const OptionRow& row : rows(line)) all.push_back(row);
    return all;
}

std::vector<std::string> said_and(Idle idle, const std::map<std::string, std::string>& said) {
    CommandLine nobody;
    std::vector<std::string> names;
    for (const OptionRow& row : option_rows(nobody))
        if (row.idle == idle && said.contains(row.name())) names.push_back(row.name());
    return names;
}

}  // namespace render2mpeg::app
