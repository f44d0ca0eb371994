#include "app/loop/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "app/loop/pipeline.h"
#include "app/loop/scene_settings.h"
#include "app/options/output_kind.h"
#include "app/system/image_reader.h"
#include "app/system/memory_limit.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/av/file_size.h"
#include "encoder/codec.h"
#include "image/image.h"
#include "parallel/loops.h"
#include "renderer/lights/anchors.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Bytes of one, beside the scene as it was read: what was measured and 10 to 30 % more. fit:
/// docs/measurements.md#memory
constexpr std::uint64_t per_triangle = 135;
constexpr std::uint64_t per_lamp = 1300;
constexpr std::uint64_t per_candidate = 400;  ///< of the places that anchors are chosen from
constexpr std::uint64_t per_pixel = 250, per_sample = 60;
constexpr std::uint64_t per_pixel_looked_at_closer = 500;
constexpr std::uint64_t per_exposed_sample = 40;
constexpr std::uint64_t per_followed_pixel = 1600;      ///< where light changes and records follow
constexpr std::uint64_t samples_of_blurred_lamps = 32;  ///< of a pixel on the average, where a lens blurs
constexpr std::uint64_t per_decoded_pixel = 48;
constexpr std::uint64_t always = std::uint64_t{24} << 20;

/// Triangles and segments of strands in Embree: rigid objects share their mesh's, others have their own.
std::uint64_t triangles_of(const scene::Animation& film) {
    std::uint64_t count = 0;
    std::set<int> shared;
    for (const scene::Object& object : film.objects)
        if (object.mobility != scene::Mobility::rigid || shared.insert(object.mesh).second)
            count += film.meshes[static_cast<std::size_t>(object.mesh)].primitives();
    return count;
}

/// Samples over shutter and lens of a pixel of the finest picture; 0: none.
std::uint64_t most_exposure_samples(const RenderJob& film) {
    if (!film.plan.runs(renderer::Pass::shutter) && !film.plan.runs(renderer::Pass::lens)) return 0;
    const bool fixed = film.coding.rate_control.mode == encoder::RateMode::constant_quantiser;
    return static_cast<std::uint64_t>(
               exposure_samples(film, fixed ? film.coding.quantiser : encoder::facts_of(film.coding.codec).finest)
                   .most) +
           (film.plan.runs(renderer::Pass::lens) ? samples_of_blurred_lamps : 0);
}

std::string size_text(std::uint64_t bytes) {
    const double mib = static_cast<double>(bytes) / (1 << 20);
    return mib < 1000 ? fmt::format("{:.0f} MiB", mib) : fmt::format("{:.1f} GiB", mib / 1024);
}

/// Frames of a window: a first picture, and P and B pictures behind it in about the shares that a film has.
/// chosen: 6 (3 to 9).
constexpr int window_frames = 6;

/// Windows of a film, spread evenly: as many as shots, so that long ones count more. chosen: 4 at most (3 to 8).
int windows_of(const RenderJob& film) {
    return std::min(1 + static_cast<int>(cuts_of(film).size()), 4);
}

/// Longest side of the smallest pictures; each size after it has four times the pixels. chosen: 48 (32 to 96).
constexpr double least_side = 48;

/// Of pictures that are predicted, how many are P pictures; windows end before their longest runs of B pictures do.
/// fit: a third in eleven films of animations/, two in five in their windows.
constexpr double p_share = 0.27, p_share_weight = 6;

/// Later frames of a chunk over those of a window at its beginning: light that is kept serves them. fit:
/// bench/fits/forecast.jsonl
constexpr double kept_later = 0.93, bytes_later = 1.1;

/// CPU and bytes grow with these powers of the pixels where one size alone is known. fit: bench/fits/forecast.jsonl
constexpr double time_power = 0.5, bits_power = 0.8;

/// A first pass's share of the film's time. chosen: a sixteenth of the pixels, roughly lit.
constexpr double first_pass_share = 0.05;

double pixels_of(const Size& size) {
    return static_cast<double>(size.width) * size.height;
}

Size size_of(const RenderJob& film) {
    return {film.format.width, film.format.height};
}

/// A mean with a default.
struct Mean {
    double sum = 0, count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    double or_else(double instead) const { return core::divide_or(sum, count, instead); }
};

/// Groups of pictures, begun by chunks and cuts.
double groups_of(const RenderJob& film, const std::vector<std::int64_t>& cuts) {
    double groups = 0;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop)) {
        std::int64_t begin = chunk.first;
        const auto add = [&](std::int64_t end) {
            groups += std::ceil(static_cast<double>(end - begin) / static_cast<double>(film.coding.gop));
            begin = end;
        };
        for (const std::int64_t cut : cuts)
            if (cut > chunk.first && cut <= chunk.last) add(cut);
        add(chunk.last + 1);
    }
    return groups;
}

/// Mean cost of later frames, by the film's shares of P and B pictures.
FrameCost later_of(std::span<const FrameEntry> frames, const std::vector<std::int64_t>& firsts) {
    Mean seconds[2], bytes[2];  // of P pictures, and of B pictures or what is not coded
    for (const FrameEntry& entry : frames) {
        if (std::ranges::find(firsts, entry.frame) != firsts.end()) continue;
        const int kind = entry.type == 'P' || entry.type == 'I' ? 0 : 1;
        seconds[kind].add(entry.seconds);
        bytes[kind].add(static_cast<double>(entry.bytes));
    }
    if (seconds[0].count == 0 || seconds[1].count == 0) {
        const int known = seconds[0].count == 0 ? 1 : 0;
        return {seconds[known].or_else(0), bytes[known].or_else(0)};
    }
    const double all = seconds[0].count + seconds[1].count,
                 p = (p_share * p_share_weight + seconds[0].count) / (p_share_weight + all);
    return {p * seconds[0].or_else(0) + (1 - p) * seconds[1].or_else(0),
            p * bytes[0].or_else(0) + (1 - p) * bytes[1].or_else(0)};
}

/// Settles the film's exposure. Whether nobody interrupted.
bool settle(RenderJob& film) {
    if (!film.images->read_ahead(image_probes(false))) return false;
    if (!film.exposure) film.exposure = measure_exposure(film);
    return !InterruptGuard::requested();
}

/// Exponent of seconds over pixels between two samples.
double power_between(double smaller, double larger, double times) {
    if (!(smaller > 0 && larger > 0 && times > 1.5)) return time_power;
    // chosen: no film takes less than a fifth more in four times the pixels, or more than they are (0 to 1.1).
    return std::clamp(std::log(larger / smaller) / std::log(times), 0.15, 1.0);
}

/// A window of the largest pictures that there was time for, and how their time grows with their pixels.
struct Sampled {
    FrameSample largest;
    double power = time_power;
};

/// Seconds on the clock, or of CPU where a busy machine gives fewer.
class SpentTime {
  public:
    double seconds() const { return std::min(clock_seconds() - clock_, cpu_seconds() - cpu_); }

  private:
    double clock_ = clock_seconds(), cpu_ = cpu_seconds();
};

/// Larger and larger pictures, as long as there is time. None without a first one.
std::optional<Sampled> sample_sizes(const RenderJob& film, const SpentTime& spent, double limit, bool quiet) {
    std::optional<Sampled> found;
    double scale = std::min(1.0, least_side / std::max(film.format.width, film.format.height));
    for (;; scale = std::min(1.0, 2 * scale)) {
        const double began = spent.seconds();
        const RenderJob job = resized(film, scale);
        const std::vector<Chunk> windows = middle_windows(job, windows_of(film), window_frames);
        Progress progress(static_cast<std::int64_t>(windows.size()) * windows.front().frames(), quiet, "sample",
                          Counted::parts_of_step);
        LoopObserver nobody;
        // The first sample is needed, and may take three times as long.
        const double end = found ? limit : limit + 2 * (limit - began);
        const std::optional<FrameSample> sample =
            sample_frames(job, windows, nobody, progress, [&] { return spent.seconds() > end; });
        if (!sample) return InterruptGuard::requested() ? std::nullopt : found;
        // Times of some shots are not those of all.
        if (found && sample->windows < static_cast<int>(windows.size())) return found;
        const double times = found ? pixels_of(sample->size) / pixels_of(found->largest.size) : 1;
        const double power =
            found ? power_between(found->largest.later.seconds, sample->later.seconds, times) : time_power;
        found = {*sample, power};
        const double next = std::min(1.0, 2 * scale) / scale, now = spent.seconds();
        if (scale >= 1 || (now - began) * std::pow(next * next, time_power) > limit - now) return found;
    }
}

double sound_bytes(const av::Sound& sound, const std::filesystem::path& output, double seconds) {
    if (sound.file.empty()) return 0;
    const std::string ending = core::ending_of(output);
    const bool aac = ending == ".mp4" || ending == ".mov" || ending == ".mkv";
    return sound.channels * (aac ? av::aac_rate : av::other_rate) / 8.0 * seconds;
}

double file_bytes(const RenderJob& film, const std::filesystem::path& output, double pictures) {
    const auto frames = static_cast<double>(film.frame_count());
    const double pixels = pixels_of(size_of(film));
    // chosen: half floats that hardly compress; PNG of rendered pictures has 1.2 to 2.2 bytes a pixel.
    if (film.kind == OutputKind::exr) return 6 * pixels * frames;
    if (film.kind == OutputKind::png) return 1.7 * pixels * frames;
    if (film.kind == OutputKind::y4m) return 1.5 * pixels * frames;
    const std::int64_t rate = film.coding.rate_control.bit_rate;
    const double bytes = rate > 0 ? static_cast<double>(rate) / 8 * frames / film.rate.hertz.value() : pictures;
    // chosen: what containers take is told for films that must not be larger; half of it is usual.
    return bytes + 0.5 * (av::file_of_pictures(bytes, film.frame_count(), output, film.disc) - bytes) +
           sound_bytes(film.sound, output, frames / film.rate.hertz.value());
}

std::string range_text(const std::string& middle, const std::string& low, const std::string& high) {
    return middle + " (" + low + " to " + high + ")";
}

std::string bytes_text(double bytes) {
    return bytes < 1e6 ? fmt::format("{:.0f} kB", 1e-3 * bytes) : fmt::format("{:.3g} MB", 1e-6 * bytes);
}

}  // namespace

MemoryNeed memory_need(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    MemoryNeed need;
    need.held = own_memory().resident;
    need.triangles = per_triangle * triangles_of(scene);
    for (const scene::Object& object : scene.objects)
        if (object.mobility == scene::Mobility::deforming)
            need.moving += per_triangle * scene.meshes[static_cast<std::size_t>(object.mesh)].primitives();
    for (const auto& [image, header] : film.images->headers()) {
        const std::uint64_t pixels =
            static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
        // Mip levels take a third more.
        need.textures += pixels * (header.bytes ? 4 : 16) * 4 / 3;
        need.decoding = std::max(need.decoding, per_decoded_pixel * pixels);
    }
    need.lights = per_lamp * (static_cast<std::uint64_t>(film.rendering.direct_points) + scene.lights.size()) +
                  per_candidate * renderer::candidates_for(static_cast<std::uint64_t>(film.rendering.vpls));
    const std::uint64_t closer = film.rendering.most_samples > 0 ? per_pixel_looked_at_closer : 0;
    const bool follows = film.rendering.indirect == renderer::Indirect::rays &&
                         film.rendering.cache != renderer::CacheUse::off && scene::traits_of(scene).changes_light();
    need.frames = always + (per_pixel + closer + (follows ? per_followed_pixel : 0) +
                            per_sample * static_cast<std::uint64_t>(film.rendering.samples) +
                            per_exposed_sample * most_exposure_samples(film)) *
                               static_cast<std::uint64_t>(film.format.width) *
                               static_cast<std::uint64_t>(film.format.height);
    return need;
}

bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads) {
    if (need.total() + need.decoding * static_cast<std::uint64_t>(std::max(threads - 1, 0)) <= limit) return true;
    if (need.total() <= limit) return false;
    throw core::Error(
        "rendering", film.animation->source,
        fmt::format(
            "it takes about {}, and --memory allows {}: {} for what was read, {} for triangles, {} for textures, "
            "{} to read the largest of them, {} for lights, {} for frames",
            size_text(need.total()), size_text(limit), size_text(need.held), size_text(need.triangles),
            size_text(need.textures), size_text(need.decoding), size_text(need.lights), size_text(need.frames)));
}

FrameSample FrameSample::grown(double times, double power) const {
    FrameSample grown = *this;
    // Headers of a picture and its slices. fit: bench/fits/forecast.jsonl
    const auto headers = [](double rows) { return 16 + 8 * rows; };
    const double rows = std::ceil(size.height / 16.0), least = headers(rows), most = headers(rows * std::sqrt(times));
    for (FrameCost* cost : {&grown.first, &grown.later}) {
        cost->seconds *= std::pow(times, power);
        if (cost->bytes > 0) cost->bytes = most + std::max(0.0, cost->bytes - least) * std::pow(times, bits_power);
    }
    return grown;
}

std::optional<FrameSample> light_windows(RenderJob film, renderer::Renderer& renderer,
                                         const std::vector<Chunk>& windows, LoopObserver& observer,
                                         RunStatistics& statistics, const std::function<bool()>& frame_done,
                                         const std::function<bool()>& stops) {
    FrameSample found;
    found.size = size_of(film);
    const double began = clock_seconds(), cpu_before = cpu_seconds();
    const std::size_t frames_before = statistics.frames.size();
    // Frames behind cuts within a window are of neither kind.
    std::vector<std::int64_t> fresh = cuts_of(film);
    Mean seconds, bytes;
    for (const Chunk& window : windows) {
        // It owes the next window nothing of a decoder's buffer.
        film.frames = {window.first, window.last};
        const std::size_t before = statistics.frames.size();
        const double start = cpu_seconds();
        double first = 0;
        bool goes_on = true;
        render_chunk(
            film, renderer, window, observer, statistics,
            [&] {
                if (statistics.frames.size() == before + 1) first = cpu_seconds() - start;
                return goes_on = frame_done();
            },
            stops);
        if (!goes_on || InterruptGuard::requested()) return {};
        if (statistics.frames.size() == before) break;
        fresh.push_back(window.first);
        ++found.windows;
        seconds.add(first);
        bytes.add(static_cast<double>(statistics.frames[before].bytes));
        if (stops()) break;
    }
    if (found.windows == 0) return {};
    found.frames = static_cast<int>(statistics.frames.size() - frames_before);
    found.cpu = cpu_seconds() - cpu_before;
    found.clock = clock_seconds() - began;
    found.first = {seconds.or_else(0), bytes.or_else(0)};
    found.later = found.frames > found.windows ? later_of(std::span(statistics.frames).subspan(frames_before), fresh)
                                               : found.first;
    return found;
}

std::optional<FrameSample> sample_frames(const RenderJob& job, const std::vector<Chunk>& windows,
                                         LoopObserver& observer, Progress& progress,
                                         const std::function<bool()>& is_over) {
    const double cpu_before = cpu_seconds();
    renderer::Renderer renderer = renderer_of(job);
    const double built = cpu_seconds() - cpu_before;
    RunStatistics statistics;
    std::optional<FrameSample> found = light_windows(
        job, renderer, windows, observer, statistics,
        [&] {
            progress.advance();
            return !InterruptGuard::requested();
        },
        [&] { return InterruptGuard::requested() || is_over(); });
    const bool is_enough = found && (found->frames > found->windows || windows.front().frames() == 1);
    if (!is_enough) return {};
    found->built = built;
    found->statistics = totals_of(statistics, renderer);
    return found;
}

std::vector<std::int64_t> cuts_of(const RenderJob& film) {
    std::vector<std::int64_t> cuts;
    int camera = -1;
    for (const scene::Shot& shot : film.animation->shots) {
        if (shot.frame > film.frames.first && shot.frame <= film.frames.last && shot.camera != camera)
            cuts.push_back(shot.frame);
        camera = shot.camera;
    }
    return cuts;
}

RenderJob resized(const RenderJob& film, double scale) {
    RenderJob job = film;
    const auto side = [&](int pixels) {
        return std::min(pixels, std::max(16, static_cast<int>(std::lround(scale * pixels / 2)) * 2));
    };
    job.format.width = side(film.format.width);
    job.format.height = side(film.format.height);
    job.rendering.format = job.format;
    job.coding.width = job.format.width;
    job.coding.height = job.format.height;
    job.audit = 0;
    job.two_passes = false;
    return job;
}

std::vector<Chunk> middle_windows(const RenderJob& film, int count, int length) {
    const std::int64_t all = film.frame_count();
    if (all <= static_cast<std::int64_t>(count) * length) return {{0, film.frames.first, film.frames.last}};
    std::vector<Chunk> windows;
    for (int i = 0; i < count; ++i) {
        const std::int64_t first = film.frames.first + (2 * i + 1) * all / (2 * count) - length / 2;
        windows.push_back({i, first, first + length - 1});
    }
    return windows;
}

FrameCost film_by(const RenderJob& film, const FrameSample& sample) {
    const std::vector<std::int64_t> cuts = cuts_of(film);
    const auto frames = static_cast<double>(film.frame_count());
    const auto starts =
        std::min(frames, static_cast<double>(chunks_of(film.frames, film.coding.gop).size() + cuts.size()));
    const double groups = std::min(frames, groups_of(film, cuts));
    // Frames far behind a short window differ from it.
    const double length = sample.windows > 0 ? static_cast<double>(sample.frames) / sample.windows : window_frames,
                 unlike = frames <= length ? 0 : std::min(1.0, window_frames / length),
                 kept = 1 + unlike * (kept_later - 1), more = 1 + unlike * (bytes_later - 1);
    return {starts * sample.first.seconds + (frames - starts) * kept * sample.later.seconds,
            groups * sample.first.bytes + (frames - groups) * more * sample.later.bytes};
}

std::optional<Forecast> forecast(RenderJob& film, const std::filesystem::path& output, double within, bool quiet) {
    const SpentTime spent;
    if (!settle(film)) return {};
    const double once = cpu_seconds();
    const std::optional<Sampled> sampled = sample_sizes(film, spent, within, quiet);
    if (!sampled) return {};
    Forecast forecast;
    forecast.sample = sampled->largest;
    const FrameSample grown =
        sampled->largest.grown(pixels_of(size_of(film)) / pixels_of(sampled->largest.size), sampled->power);
    const FrameCost whole = film_by(film, grown);
    forecast.first = grown.first;
    forecast.later = grown.later;
    forecast.cpu = whole.seconds * (film.two_passes ? 1 + first_pass_share : 1) + once + grown.built;
    forecast.once = once + grown.built;
    forecast.clock = forecast.cpu * core::divide_or(grown.clock, grown.cpu + grown.built, 1.0);
    forecast.bytes = file_bytes(film, output, whole.bytes);
    forecast.disk = is_one_file(film.kind) ? 2 * forecast.bytes : forecast.bytes;
    forecast.memory = memory_need(film).total();
    // fit: bench/fits/forecast.jsonl: nine of ten films; each four times the pixels that are not lit add as much again.
    const double fours = std::log(pixels_of(size_of(film)) / pixels_of(grown.size)) / std::log(4.0);
    forecast.spread = std::min(0.6, 0.15 + 0.1 * std::max(0.0, fours));
    return forecast;
}

std::string film_text(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    const scene::Traits traits = scene::traits_of(scene);
    int camera = 0;
    for (const scene::Shot& shot : scene.shots)
        if (shot.frame <= film.frames.first) camera = shot.camera;
    std::string lights;
    const auto add = [&](const std::string& text) { lights += (lights.empty() ? "" : ", ") + text; };
    if (!scene.lights.empty()) add(core::counted(scene.lights.size(), "lamp"));
    if (traits.has_emissive_surfaces) add("surfaces that shine");
    if (traits.has_shining_sky) add("the sky");
    const std::string name = scene.cameras[static_cast<std::size_t>(camera)].name;
    const auto shots = scene.shots.size();
    return core::printable(
        fmt::format("{}: {} frames ({} to {}; {:.2f} s) of {}x{} at {} Hz; camera {}{}; light: {}", scene.source,
                    film.frame_count(), film.frames.first, film.frames.last,
                    static_cast<double>(film.frame_count()) / film.rate.hertz.value(), film.format.width,
                    film.format.height, film.rate.name, name.empty() ? std::to_string(camera) : "\"" + name + "\"",
                    shots > 1 ? fmt::format(" first, {} shots", shots) : "", lights.empty() ? "none" : lights));
}

std::string text_of(const Forecast& f) {
    const auto range = [&](double value, auto&& text) {
        return range_text(text(value), text(value * (1 - f.spread)), text(value * (1 + f.spread)));
    };
    return fmt::format(
        "Takes about {} on this machine's {} thread{}, {:.0f} s of CPU time; the film has about {}.\n"
        "Memory: about {:.0f} MiB. Disk while it is made: about {}. From {} frames lit at {}x{}.\n",
        range(f.clock, clock_text), parallel::thread_count(), parallel::thread_count() == 1 ? "" : "s", f.cpu,
        range(f.bytes, bytes_text), static_cast<double>(f.memory) / (1 << 20), bytes_text(f.disk), f.sample.frames,
        f.sample.size.width, f.sample.size.height);
}

}  // namespace render2mpeg::app
