#pragma once
// Options of all commands.
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/glare.h"

namespace render2mpeg::app {

struct ToleranceRequest {
    bool reference = false;                     ///< every light point, no clustering; with `truth` by paths instead
    float relative = 0.02f;                     ///< else: share of each pixel's luminance
    bool coupled = false;                       ///< instead: errors masked by coding and the eye
    std::optional<float> fraction;              ///< of it, > 0; none: derived from the quantiser
    std::optional<float> truth = std::nullopt;  ///< standard error of a pixel over its luminance
};

struct ShutterRequest {
    float angle = 0, phase = 0, rolling = 0;
};

struct GlareRequest {
    core::GlareKind kind = core::GlareKind::off;
    std::optional<float> strength;  ///< none: the animation file's, or that of real eyes
};

/// Pictures of a GOP by default. chosen: 60, two seconds, for seeking and chunks (film.h). Against 15 that takes 7.3 to
/// 29 % fewer bits, against 30 2.7 to 3.2 % where much moves (docs/measurements.md#encoder).
inline constexpr int usual_gop = 60;

/// Coding options of `render` and `encode`.
struct CodingOptions {
    std::optional<std::string> codec;    ///< none: as the ending of the output's name says
    std::optional<int> quantiser;        ///< MPEG-2's; none: 4, where neither quality nor bit rate are asked for
    std::optional<int> crf;              ///< instead, in the codec's scale
    std::optional<double> quality;       ///< 0..100
    std::optional<std::string> bitrate;  ///< as bits_from reads it; likewise the next two
    std::optional<std::string> maxrate;
    std::optional<std::string> vbv;
    bool constant_rate = false;                               ///< --cbr
    std::optional<int> passes;                                ///< 1 or 2
    std::optional<int> gop;                                   ///< none: usual_gop, or the preset's
    std::optional<int> b_pictures;                            ///< most in a row; none: 3, or the preset's
    std::string tune = "psnr";                                ///< "psnr" or "perceptual"
    std::string encoder = "quality";                          ///< "fast" or "quality"
    std::optional<std::string> preset;                        ///< --for
    std::optional<std::string> display_aspect, pixel_aspect;  ///< "W:H", not both
    std::optional<std::string> keyframes;                     ///< frame numbers, or a file with them
    std::optional<std::string> audio;                         ///< a file, or "none"
    double audio_offset = 0;                                  ///< seconds of frame 0's film at which it begins
};

/// Options of `render` and `encode`.
struct FilmOptions {
    std::filesystem::path input;  ///< a scene; of `encode` a Y4M file, numbered images, or "-": Y4M from standard input
    std::filesystem::path output;
    std::optional<std::string> as;  ///< format on standard output: "ts", "m2v" or "y4m"; `output` is "-.ts" then
    std::optional<std::string> rate;
    std::optional<std::string> frames;  ///< "A:B", inclusive
    std::optional<std::string> view;    ///< a name of core::view_names; wins over the animation file's
    CodingOptions coding;
    int threads = 0;  ///< 0: all
    std::optional<std::filesystem::path> stats;
    bool quiet = false;
    bool overwrite = false;  ///< replace films and make folders without a question
    /// Options of the command line by their long names: the words behind each.
    std::map<std::string, std::string> said;

    bool is_given(const std::string& name) const { return said.contains(name); }
};

struct RenderOptions : FilmOptions {
    std::optional<std::string> size;  ///< "WxH"
    int samples = 4;
    std::optional<int> edge_samples;  ///< none: as many as `samples` where that was given, else 16 or 64
    std::string indirect = "rays";    ///< or "lightcuts"
    int vpls = 4096;
    std::string caustics = "on";             ///< "on" or "off"
    std::optional<std::string> tolerance;    ///< none: "coupled" for films, else "fixed=2%"
    std::string masking = "warped";          ///< "warped" or "quantised"
    int audit = 0;                           ///< pixels of every frame
    std::string exposure = "auto";           ///< "auto" or a number of EV; the animation file's wins over "auto"
    std::optional<std::string> shutter;      ///< as shutter_from() reads it; wins over the animation file's
    std::optional<std::string> f_stop;       ///< a number, or "off"; likewise
    std::optional<std::string> focus;        ///< a distance, or an object's name; likewise
    std::optional<int> exposure_samples;     ///< none: by quantiser
    std::optional<std::string> fog;          ///< as fog_from() reads it; wins over the animation file's
    std::optional<std::string> glare;        ///< as glare_from() reads it; wins over the animation file's
    std::optional<std::string> transparent;  ///< "on" or "off"; likewise
    std::string clamp = "bounded";           ///< "bounded" or "none"
    std::string cache = "auto";              ///< "on", "off" or "auto"
    std::optional<std::filesystem::path> light_cache;  ///< --light-cache
    std::optional<std::string> sky;                    ///< image file or "none"
    std::string light = "studio";                      ///< of scenes without any: "studio", "even" or "none"
    std::optional<std::string> camera;
    std::optional<std::string> animation;
    std::optional<std::string> variant;
    std::optional<std::string> isa;
    std::optional<std::filesystem::path> report;                ///< HTML
    std::optional<std::filesystem::path> layers;                ///< --aov
    std::optional<std::filesystem::path> last_frame;            ///< --last-frame
    std::vector<std::pair<std::string, std::string>> heatmaps;  ///< subject, file
    bool preview = false;                                       ///< a draft
    std::optional<std::string> effort;                          ///< "draft", or a name of `efforts`
    std::string player;                                         ///< of `watch`; empty: whichever is at hand
    bool dry_run = false;
    bool resume = false;
    bool hold = false;  ///< frames outside the film are wanted
    bool verbose = false;
    std::string within = "10s";         ///< for sample frames that tell what the film takes; "0": none
    std::optional<std::string> memory;  ///< as memory_from() reads it; none: all that there is
    std::optional<int> chunks_at_once;  ///< none: by cores and memory
};

struct EncodeOptions : FilmOptions {
    std::optional<std::filesystem::path> motion;  ///< numbered OpenEXR files, or a motion stream: "fd:N" or a pipe
    std::string motion_convention = "blender";    ///< "blender" or "nuke"
    std::optional<float> exposure;                ///< EV, for scene-linear frames
};

struct InfoOptions {
    std::filesystem::path input;
    bool json = false;
    bool summary = false;  ///< without the pictures one by one
};

/// Sample of a film: windows of consecutive frames; fewer in short films.
struct Sample {
    int windows = 2, frames = 3;  ///< >= 1
};

/// Options of `cost`, `tune` and `compare`.
struct TrialOptions {
    RenderOptions render;  ///< decides light and coding; `output` may be empty
    std::optional<std::filesystem::path> json;
    std::optional<std::filesystem::path> report;  ///< HTML
    std::optional<std::string> sample;            ///< none: by the command
    std::optional<int> references;                ///< of every window; none: by the command

    std::string within = "1m";  ///< of `cost`, as time_in_seconds reads it
    std::string tolerances = "16,8,4,2,1";
    std::string quantisers = "2,4,8,16";  ///< of `compare`

    /// Targets of `tune`, exactly one of them.
    std::optional<double> psnr;          ///< dB
    std::optional<double> ssim;          ///< 0..1
    std::optional<std::string> bitrate;  ///< as bits_from reads it
    std::optional<std::string> size;     ///< as size_in_bytes reads it
    std::optional<std::string> time;     ///< as time_in_seconds reads it
    std::string of = "film";             ///< "film" or "worst-tenth": whose quality is meant
};

/// Schedulers of `farm --to`.
inline constexpr std::array<std::string_view, 7> scheduler_names{"slurm",  "parallel",  "sge",     "kubernetes",
                                                                 "openjd", "snakemake", "flamenco"};

struct FarmOptions {
    RenderOptions render;                         ///< as they were read; parts read them again from the plan
    std::string scheduler;                        ///< a name of scheduler_names
    std::optional<int> parts;                     ///< not with the next; none of both: a part per chunk
    std::optional<std::int64_t> frames_per_part;  ///< at least one chunk's, rounded to whole ones
    bool submit = false;
    bool pack = false;  ///< with copies of all inputs
};

/// Options of `part`, `join` and `farm-status`.
struct PartOptions {
    std::filesystem::path plan;                   ///< a farm's folder, or its plan.json
    std::optional<int> number;                    ///< of the part, from 1; not with the next
    std::optional<std::string> frames;            ///< "A-B": all parts that begin with one of these frames
    std::optional<std::filesystem::path> folder;  ///< where the join puts everything; none: as `farm` was told
    bool left = false;                            ///< tell only the numbers of parts that are not whole
    int threads = 0;                              ///< 0: all
    std::optional<std::string> memory;            ///< as in RenderOptions
    bool quiet = false;
};

enum class Command { render, encode, plan, info, cost, tune, compare, watch, farm, part, join, farm_status, none };

/// A parsed command line. `exit_code` is set after --help and --version.
struct CommandLine {
    Command command = Command::none;
    RenderOptions render;  ///< also of `plan` and `watch`
    EncodeOptions encode;
    InfoOptions info;
    TrialOptions trial;
    FarmOptions farm;
    PartOptions part;
    std::string progress = "line";  ///< "line", "minute", "json", "openjd" or "none"
    std::optional<int> exit_code;
    std::string text;                ///< as given, for the statistics
    std::vector<std::string> words;  ///< the same, one by one
};

/// Throws UsageError: one line with the wrong name and the right form.
CommandLine parse(int argc, char** argv);

/// When an option changes no byte of a film.
enum class Idle {
    never,
    always,           ///< speaks of the run alone
    uncoded,          ///< where nothing is coded
    unexposed,        ///< in the scene's own light, where none of it is too dark to matter
    undeveloped,      ///< in the scene's own light
    traced,           ///< where paths over the whole pixel bring its light
    without_points,   ///< where rays or paths bring bounced light
    uncoupled,        ///< where the tolerance is not coupled to coding
    without_vectors,  ///< where no motion is given
};

/// Those of `said` that are idle in such a case, in the table's order.
std::vector<std::string> said_and(Idle idle, const std::map<std::string, std::string>& said);

/// A word quoted for a shell.
std::string quoted(const std::string& word);

/// As size_from() and frames_from() read them (option_text.h).
struct Size {
    int width = 0, height = 0;
};
struct FrameRange {
    std::int64_t first = 0, last = 0;  ///< both inclusive
};

/// Words of another command: without `without` (of which `flags` take no value), with `with` appended (name, value or
/// empty).
std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with);

/// Words of the `render` that a `farm` stands for.
std::vector<std::string> render_words(const std::vector<std::string>& farm);

std::string line_of(const std::vector<std::string>& words);

}  // namespace render2mpeg::app
