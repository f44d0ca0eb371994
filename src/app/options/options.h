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
#include "core/isa.h"
#include "core/rational.h"
#include "core/view.h"
#include "encoder/types.h"

namespace render2mpeg::app {

struct Size {
    int width = 0, height = 0;
};
struct FrameRange {
    std::int64_t first = 0, last = 0;  ///< both inclusive

    std::int64_t count() const { return last - first + 1; }
};

/// dB of PSNR-Y that light may lose in coded films. chosen: 0.2: nobody sees it, and half of it takes about twice the
/// rays.
inline constexpr double usual_loss = 0.2;

struct ToleranceRequest {
    bool reference = false;                     ///< every light point, no clustering; with `truth` by paths instead
    float relative = 0.02f;                     ///< else: share of each pixel's luminance
    bool coupled = false;                       ///< instead: errors masked by coding and the eye
    std::optional<float> fraction;              ///< of it, > 0; none: by what the film loses
    std::optional<float> truth = std::nullopt;  ///< standard error of a pixel over its luminance
    double loss = usual_loss;                   ///< coupled without a fraction: dB, > 0
};

inline ToleranceRequest fixed_tolerance(float share) {
    ToleranceRequest request;
    request.relative = share;
    return request;
}

inline ToleranceRequest coupled_tolerance() {
    ToleranceRequest request = fixed_tolerance(0);
    request.coupled = true;
    return request;
}

struct ShutterRequest {
    float angle = 0, phase = 0, rolling = 0;
};

struct GlareRequest {
    core::GlareKind kind = core::GlareKind::off;
    std::optional<float> strength;  ///< none: the animation file's, or that of real eyes
};

/// Sample of a film: windows of consecutive frames; fewer in short films.
struct SampleExtent {
    int windows = 2, frames = 3;  ///< >= 1
};

/// Pictures of a GOP by default. chosen: 60, two seconds, for seeking and chunks (film.h). Against 15 that takes 7.3 to
/// 29 % fewer bits, against 30 2.7 to 3.2 % where much moves (bench/tables/encoder.csv).
inline constexpr int usual_gop = 60;

// Members of options are what their rows in option_table.cpp say; texts are as option_text.h reads them.

struct Preset;

/// Coding options of `render` and `encode`.
struct CodingOptions {
    std::optional<encoder::Codec> codec;
    const Preset* preset = nullptr;  ///< of --for (shape.h); null: none
    std::optional<std::string> keyframes, audio, title, timecode;
    std::optional<int> level;                           ///< ten times its number
    std::optional<std::int64_t> bitrate, maxrate, vbv;  ///< bits per second; bits
    std::optional<core::Rational> display_aspect, pixel_aspect;
    std::optional<int> quantiser, crf, passes, gop, b_pictures;
    std::optional<double> quality;
    bool constant_rate = false;
    std::optional<std::string> tune;  ///< none: as the codec has it
    std::string encoder = "quality";
    double audio_offset = 0;
};

/// Options of `render` and `encode`.
struct FilmOptions {
    std::filesystem::path input, output;  ///< `output` is "-.ts" where `as` is "ts"
    std::optional<std::string> as;
    std::optional<core::FrameRate> rate;
    std::optional<core::ViewName> view;
    std::optional<FrameRange> frames;
    std::optional<int> grain;  ///< ISO; 0: none
    std::optional<int> peak;   ///< white of films in PQ, cd/m^2; none: core::usual_peak
    CodingOptions coding;
    int threads = 0;  ///< 0: all
    std::optional<std::filesystem::path> stats;
    bool quiet = false, overwrite = false;
    /// Options of the command line by their long names: the words behind each.
    std::map<std::string, std::string> said;

    bool is_given(const std::string& name) const { return said.contains(name); }
    /// "--size 640x360", as it was given; the name alone where it was not.
    std::string as_said(const std::string& name) const { return is_given(name) ? name + " " + said.at(name) : name; }
};

/// A film of `--also`: "pq", "neutral:prores".
struct ViewAndCodec {
    core::View view;
    std::optional<encoder::Codec>
        codec;  ///< none: by the file's ending, HEVC for high dynamic range where that has 8 bits

    encoder::Codec codec_in(const std::filesystem::path& output) const;
};

/// A film that is to be written beside the film.
struct SideFilmRequest {
    std::string subject;  ///< as it was given
    std::filesystem::path file;
    std::optional<ViewAndCodec> view;  ///< none: a heatmap of the subject
};

/// In any currency.
struct Price {
    double amount = 0;
    bool of_core = true;  ///< for each core and hour; else for each machine

    double of_core_hour(int cores) const { return of_core ? amount : amount / cores; }
};

/// Machines to be had for a film, and what they cost.
struct Hire {
    std::optional<Price> price;
    std::optional<int> machines, cores;
};

/// What is given wins over the animation file.
struct RenderOptions : FilmOptions {
    std::optional<Size> size;
    std::optional<ToleranceRequest> tolerance;
    std::optional<ShutterRequest> shutter;
    std::optional<GlareRequest> glare;
    std::optional<float> f_stop;          ///< 0: all is sharp
    std::optional<float> fog;             ///< visibility, scene units; 0: none
    std::optional<std::uint64_t> memory;  ///< bytes
    std::optional<std::string> focus, transparent, sky, camera, projection, stereo, animation, variant, effort;
    std::optional<core::Isa> isa;
    std::optional<float> exposure;  ///< EV; none: the animation file's, else one value for the film by what it shows
    std::optional<double> loss;     ///< none: usual_loss, or --effort's
    int samples = 4, vpls = 32768, audit = 0;
    std::optional<int> edge_samples, exposure_samples, chunks_at_once;
    std::string indirect = "rays", caustics = "on", masking = "warped", clamp = "bounded", cache = "auto",
                light = "studio", player;
    double within = 10;  ///< seconds
    std::optional<std::filesystem::path> light_cache, report, layers, last_frame;
    std::vector<SideFilmRequest> side_films;
    bool preview = false, dry_run = false, resume = false, hold = false, verbose = false, live = false;
    Hire hire;
    std::string limits = "none";  ///< `blender`: a .blend's limits of bounces hold
};

struct EncodeOptions : FilmOptions {
    std::optional<std::string> projection, stereo;  ///< of the frames
    std::optional<std::string> transparent;         ///< none: as the codec can
    std::optional<std::filesystem::path> motion;
    std::string motion_convention = "blender";
    std::optional<float> exposure;
};

struct InfoOptions {
    std::filesystem::path input;
    bool json = false, summary = false;
};

/// Options of `cost`, `tune` and `compare`; of `tune` exactly one of the targets from `psnr` to `time`.
struct TrialOptions {
    RenderOptions render;
    std::optional<std::filesystem::path> json, report;
    std::optional<SampleExtent> sample;
    std::optional<std::vector<int>> quantisers;
    std::optional<std::int64_t> bitrate;  ///< bits per second
    std::optional<double> size, time;     ///< bytes; seconds
    std::optional<std::string> beside, blender;
    std::optional<int> references;
    std::optional<double> psnr, ssim;
    double within = 60;  ///< seconds
    std::vector<float> tolerances{0.16f, 0.08f, 0.04f, 0.02f, 0.01f};
    std::string of = "film";
};

/// Schedulers of `farm --to`.
inline constexpr std::array<std::string_view, 8> scheduler_names{"slurm",  "parallel",  "sge",      "kubernetes",
                                                                 "openjd", "snakemake", "flamenco", "opencue"};

struct FarmOptions {
    RenderOptions render;  ///< as they were read; parts read them again from the plan
    std::string scheduler;
    std::optional<int> parts;
    std::optional<std::int64_t> frames_per_part;
    bool submit = false, pack = false;
};

/// Options of `part`, `join` and `farm-status`.
struct PartOptions {
    std::filesystem::path plan;
    int number = 0;                        ///< of `part`, from 1
    std::optional<std::uint64_t> memory;   ///< bytes
    std::vector<std::string> after_chunk;  ///< words; none: chunks stay
    std::optional<Price> price;
    std::optional<std::filesystem::path> folder;  ///< of the film
    std::optional<std::filesystem::path> pieces;  ///< their folder
    std::filesystem::path from;                   ///< where `after_chunk` runs
    int threads = 0;
    bool left = false, quiet = false;
};

/// A parsed command line. `exit_code` is set after --help and --version.
struct CommandLine {
    std::string command;   ///< its name
    RenderOptions render;  ///< also of `plan` and `watch`
    EncodeOptions encode;
    InfoOptions info;
    TrialOptions trial;
    FarmOptions farm;
    PartOptions part;
    std::vector<std::pair<std::string, std::string>> heatmaps, also;  ///< words of `render.side_films`
    std::string progress = "line";                                    ///< "line", "minute", "json", "openjd" or "none"
    std::optional<int> exit_code;
    std::string text;                ///< as given, for the statistics
    std::vector<std::string> words;  ///< the same, one by one
};

/// Throws UsageError: one line with the wrong name and the right form.
CommandLine parse(const std::vector<std::string>& words);

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

/// Wraps text at `columns`; its own line ends stay.
std::string wrapped(const std::string& text, int columns);

/// A word quoted for a shell.
std::string quoted(const std::string& word);

/// Words of another command: without `without` (of which `flags` take no value), with `with` appended (name, value or
/// empty).
std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with);

/// Words of the `render` that a `farm` stands for.
std::vector<std::string> render_words(const std::vector<std::string>& farm);

std::string line_of(const std::vector<std::string>& words);

}  // namespace render2mpeg::app
