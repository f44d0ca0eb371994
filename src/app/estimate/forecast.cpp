#include "app/estimate/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/job/automatic_exposure.h"
#include "app/job/shots.h"
#include "app/options/output_kind.h"
#include "app/system/image_reader.h"
#include "app/system/memory_limit.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/av/file_size.h"
#include "parallel/loops.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Frames of a window: a first picture, and P and B pictures behind it in about the shares that a film has.
/// chosen: 6 (3 to 9).
constexpr int window_frames = 6;

/// Windows of a film: one for each shot. chosen: 4 at most (3 to 8).
constexpr int most_windows = 4;

/// Longest side of the smallest pictures; each size after it has four times the pixels. chosen: 48 (32 to 96).
constexpr double least_side = 48;

/// Later frames of a chunk over those of a window at its beginning: light that is kept serves them. fit:
/// bench/fits/forecast.jsonl
constexpr double kept_later = 0.93, bytes_later = 1.1;

/// Bytes grow with this power of the pixels where one size alone is known. fit: bench/fits/forecast.jsonl
constexpr double bits_power = 0.8;

/// What two sizes tell of bytes holds for larger ones by half: small pictures have hardly a predicted block of detail.
/// fit: bench/fits/forecast.jsonl
constexpr double bits_share = 0.5, least_bits_power = 0.5, most_bits_power = 1.2;

/// chosen: no film takes less than a fifth more in four times the pixels, or more than they are (0 to 1.1).
constexpr double least_power = 0.15;

/// Later frames over the first at the least, where the first was not lit in time. fit: bench/fits/forecast.jsonl
/// (median 0.75, 0.17 to 1.07)
constexpr double least_later_over_first = 0.15;

/// A first pass's share of the film's time. chosen: a sixteenth of the pixels, roughly lit.
constexpr double first_pass_share = 0.05;

/// Groups of pictures, begun by chunks and cuts.
double groups_of(const RenderJob& film) {
    double groups = 0;
    for (const Chunk& stretch : stretches_of(film, chunks_of(film.frames, film.coding.gop)))
        groups += std::ceil(static_cast<double>(stretch.frames()) / static_cast<double>(film.coding.gop));
    return groups;
}

/// Frames that begin light anew.
double starts_of(const RenderJob& film) {
    const auto starts = chunks_of(film.frames, film.coding.gop).size() + cuts_of(film).size();
    return std::min(static_cast<double>(film.frame_count()), static_cast<double>(starts));
}

/// Settles the film's exposure. Whether nobody interrupted.
bool settle(RenderJob& film) {
    if (!film.images->read_ahead(image_probes(false))) return false;
    if (!film.exposure) film.exposure = measure_exposure(film);
    return !InterruptGuard::requested();
}

/// Bytes of a picture of no detail: headers of it and of its slices. fit: bench/fits/forecast.jsonl
double least_bytes(encoder::Codec codec, double rows) {
    return codec == encoder::Codec::mpeg2 ? 16 + 8 * rows : 12;
}

double detail_of(const FrameSample& sample, double bytes) {
    return bytes - least_bytes(sample.codec, std::ceil(sample.size.height / 16.0));
}

/// The largest pictures that there was time for, and how their costs grow with the pixels.
struct Sampled {
    FrameSample largest;
    Growth growth;
    MemoryNeed need;  ///< of the film, by what it took
};

/// Seconds on the clock, or of CPU where a busy machine gives fewer.
class SpentTime {
  public:
    double seconds() const { return std::min(clock_seconds() - clock_, cpu_seconds() - cpu_); }

  private:
    double clock_ = clock_seconds(), cpu_ = cpu_seconds();
};

/// The next scale, for which `seconds` are left where the last took `took`; none where that is hardly larger. chosen:
/// twice at most, as costs are not alike far away, and a quarter more at least (1.1 to 1.5).
std::optional<double> next_scale(double scale, double took, double seconds, double power) {
    if (scale >= 1 || seconds <= 0) return {};
    // chosen: a tenth is kept, since a window that time ends is lost.
    const double times = std::pow(0.9 * seconds / std::max(took, 1e-3), 1 / std::max(power, time_power));
    const double next = std::min({1.0, 2 * scale, scale * std::sqrt(times)});
    if (next < std::min(1.0, 1.25 * scale)) return {};
    return next;
}

/// A film's need, by what this process took at most for its sample.
MemoryNeed taken_by(const RenderJob& sample, const MemoryNeed& film) {
    MemoryNeed told = memory_need(sample);
    told.held = film.held;
    return by_sample(film, told, own_memory().peak);
}

/// Larger and larger pictures, as long as there is time. None without a first one.
std::optional<Sampled> sample_sizes(const RenderJob& film, const MemoryNeed& need, const SpentTime& spent, double limit,
                                    bool quiet) {
    std::optional<Sampled> found;
    std::optional<double> scale = scale_for(film, least_side);
    while (scale) {
        const double began = spent.seconds();
        const Sample wanted{resized(film, *scale), sample_windows(film, most_windows, window_frames)};
        Progress progress(wanted.windows.frames(), quiet, "sample", Counted::parts_of_step);
        LoopObserver nobody;
        // The first sample is needed, and may take three times as long; its first frame tells the most.
        const double end = found ? limit : limit + 2 * (limit - began);
        const std::optional<FrameSample> sample =
            sample_frames(wanted, nobody, progress, [&] { return spent.seconds() > end; });
        if (!sample) return InterruptGuard::requested() ? std::nullopt : found;
        // Times of some frames are not those of all.
        if (found && sample->frames < found->largest.frames) return found;
        found = {*sample, growth_between(found ? &found->largest : nullptr, *sample), taken_by(wanted.film, need)};
        if (sample->frames == 0) return found;
        const double now = spent.seconds();
        scale = next_scale(*scale, now - began, limit - now, found->growth.later.seconds);
    }
    return found;
}

double sound_bytes(const av::Sound& sound, const std::filesystem::path& output, double seconds) {
    if (sound.file.empty()) return 0;
    const std::string ending = core::ending_of(output);
    const bool aac = ending == ".mp4" || ending == ".mov" || ending == ".mkv" || ending == ".webm";
    return sound.channels * (aac ? av::aac_rate : av::other_rate) / 8.0 * seconds;
}

double file_bytes(const RenderJob& film, const std::filesystem::path& output, double pictures) {
    const auto frames = static_cast<double>(film.frame_count());
    const double pixels = area_of(film.size());
    // chosen: half floats that hardly compress; PNG of rendered pictures has 1.2 to 2.2 bytes a pixel.
    if (film.kind == OutputKind::exr) return 6 * pixels * frames;
    if (film.kind == OutputKind::png) return 1.7 * pixels * frames;
    if (film.kind == OutputKind::y4m) return 1.5 * pixels * frames;
    const std::int64_t rate = film.coding.rate_control.bit_rate;
    const double bytes = rate > 0 ? static_cast<double>(rate) / 8 * frames / film.rate.hertz.value() : pictures;
    return av::likely_file(bytes, sound_bytes(film.sound, output, frames / film.rate.hertz.value()), film.frame_count(),
                           output, film.disc);
}

std::string range_text(const std::string& middle, const std::string& low, const std::string& high) {
    return middle + " (" + low + " to " + high + ")";
}

std::string bytes_text(double bytes) {
    return bytes < 1e4   ? fmt::format("{:.1f} kB", 1e-3 * bytes)
           : bytes < 1e6 ? fmt::format("{:.0f} kB", 1e-3 * bytes)
                         : fmt::format("{:.3g} MB", 1e-6 * bytes);
}

}  // namespace

FrameSample grown(const FrameSample& sample, double times, const Growth& growth) {
    FrameSample grown = sample;
    const double least = least_bytes(sample.codec, std::ceil(sample.size.height / 16.0) * std::sqrt(times));
    const auto grow = [&](FrameCost& cost, const FrameCost& power) {
        cost.seconds *= std::pow(times, power.seconds);
        if (cost.bytes > 0)
            cost.bytes = least + std::max(0.0, detail_of(sample, cost.bytes)) * std::pow(times, power.bytes);
    };
    grow(grown.first, growth.first);
    grow(grown.later, growth.later);
    return grown;
}

Growth growth_between(const FrameSample* smaller, const FrameSample& larger) {
    const FrameCost usual{time_power, bits_power};
    const double times = smaller != nullptr ? area_of(larger.size) / area_of(smaller->size) : 1;
    if (times <= 1) return {usual, usual};
    // Sizes that are hardly apart tell little.
    const double share = std::min(1.0, std::log(times) / std::log(4.0));
    const auto power = [&](double small, double large, double low, double high, double weight, double instead) {
        if (!(small > 0 && large > 0)) return instead;
        return (1 - weight) * instead + weight * std::clamp(std::log(large / small) / std::log(times), low, high);
    };
    const auto kind = [&](const FrameCost& small, const FrameCost& large) -> FrameCost {
        return {power(small.seconds, large.seconds, least_power, 1.0, share, time_power),
                power(detail_of(*smaller, small.bytes), detail_of(larger, large.bytes), least_bits_power,
                      most_bits_power, bits_share * share, bits_power)};
    };
    return {kind(smaller->first, larger.first), kind(smaller->later, larger.later)};
}

FrameCost film_by(const RenderJob& film, const FrameSample& sample) {
    const auto frames = static_cast<double>(film.frame_count());
    const double starts = starts_of(film);
    const double groups = std::min(frames, groups_of(film));
    // Frames far behind a short window differ from it.
    const double windows = static_cast<double>(sample.windows.size()),
                 length = windows > 0 ? sample.frames / windows : window_frames,
                 unlike = frames <= length ? 0 : std::min(1.0, window_frames / length),
                 kept = 1 + unlike * (kept_later - 1), more = 1 + unlike * (bytes_later - 1);
    return {starts * sample.first.seconds + (frames - starts) * kept * sample.later.seconds,
            groups * sample.first.bytes + (frames - groups) * more * sample.later.bytes};
}

namespace {

/// What a film takes at the least, in which the first frame of a sample was not lit in time.
Forecast least_forecast(const RenderJob& film, const FrameSample& unlit, std::uint64_t memory) {
    Forecast least;
    least.is_least = true;
    least.sample = unlit;
    const double first = unlit.cpu * std::pow(area_of(film.size()) / area_of(unlit.size), least_power);
    least.first = {first, 0};
    least.later = {least_later_over_first * first, 0};
    const double frames = static_cast<double>(film.frame_count()), starts = starts_of(film);
    least.cpu = starts * least.first.seconds + (frames - starts) * least.later.seconds + unlit.built;
    least.clock = least.cpu * core::divide_or(unlit.clock, unlit.cpu, 1.0);
    least.memory = memory;
    return least;
}

}  // namespace

std::optional<Forecast> forecast(RenderJob& film, const std::filesystem::path& output, double within, bool quiet) {
    const SpentTime spent;
    const MemoryNeed need = memory_need(film);
    if (!settle(film)) return {};
    const double once = cpu_seconds();
    const std::optional<Sampled> sampled = sample_sizes(film, need, spent, within, quiet);
    if (!sampled) return {};
    if (sampled->largest.frames == 0) return least_forecast(film, sampled->largest, need.total());
    Forecast forecast;
    forecast.sample = sampled->largest;
    const FrameSample grown =
        app::grown(sampled->largest, area_of(film.size()) / area_of(sampled->largest.size), sampled->growth);
    const FrameCost whole = film_by(film, grown);
    forecast.first = grown.first;
    forecast.later = grown.later;
    forecast.cpu = whole.seconds * (film.two_passes ? 1 + first_pass_share : 1) + once + grown.built;
    forecast.once = once + grown.built;
    forecast.clock = forecast.cpu * core::divide_or(grown.clock, grown.cpu + grown.built, 1.0);
    forecast.bytes = file_bytes(film, output, whole.bytes);
    forecast.disk = is_one_file(film.kind) ? 2 * forecast.bytes : forecast.bytes;
    forecast.memory = sampled->need.total();
    // fit: bench/fits/forecast.jsonl: nine of ten films; each four times the pixels that are not lit add as much again.
    const double fours = std::log(area_of(film.size()) / area_of(grown.size)) / std::log(4.0);
    forecast.spread = std::min(0.6, 0.15 + 0.1 * std::max(0.0, fours));
    return forecast;
}

MemoryNeed sampled(const RenderJob& film, const MemoryNeed& need) {
    // chosen: pictures of 160 pixels, the first and one more: a fourth of a frame in 320x180.
    constexpr double side = 160;
    constexpr int windows = 2, frames = 1;
    RenderJob lit = film;
    if (!lit.exposure) lit.exposure = measure_exposure(lit);
    const Sample wanted{resized(lit, scale_for(lit, side)), sample_windows(lit, windows, frames)};
    Progress progress(wanted.windows.frames(), true, "sample", Counted::parts_of_step);
    LoopObserver nobody;
    if (!sample_frames(wanted, nobody, progress, [] { return false; })) return need;
    return taken_by(wanted.film, need);
}

std::string film_text(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    const scene::Traits traits = scene::traits_of(scene);
    const int camera = camera_at(film, film.frames.first);
    std::string lights;
    const auto add = [&](const std::string& text) { lights += (lights.empty() ? "" : ", ") + text; };
    if (!scene.lights.empty()) add(core::counted(scene.lights.size(), "lamp"));
    if (traits.has_emissive_surfaces) add("surfaces that shine");
    if (traits.has_shining_sky) add("the sky");
    const std::string volumes = scene.volumes.empty() ? "" : "; " + core::counted(scene.volumes.size(), "volume");
    const scene::CameraLens& lens = scene.cameras[static_cast<std::size_t>(camera)];
    const std::string panorama = lens.is_panorama() ? ", a panorama of " + scene::text_of(lens.window) : "";
    const auto shots = scene.shots.size();
    return core::printable(fmt::format(
        "{}: {} ({} to {}; {:.2f} s) of {}x{}{} at {} Hz; camera {}{}{}; light: {}{}", scene.source,
        core::counted(static_cast<std::size_t>(film.frame_count()), "frame"), film.frames.first, film.frames.last,
        static_cast<double>(film.frame_count()) / film.rate.hertz.value(), film.format.width, film.format.height,
        eyes_text(scene.stereo), film.rate.name, lens.name.empty() ? std::to_string(camera) : "\"" + lens.name + "\"",
        panorama, shots > 1 ? fmt::format(" first, {} shots", shots) : "", lights.empty() ? "none" : lights, volumes));
}

std::string text_of(const Forecast& f) {
    const std::string memory = fmt::format("Memory: about {:.0f} MiB.", static_cast<double>(f.memory) / (1 << 20));
    if (f.is_least)
        return fmt::format(
            "Takes more than {} on this machine's {}, {:.0f} s of CPU time: in {} not one frame of {}x{} was lit. More "
            "time (--within) tells more.\n{}\n",
            clock_text(f.clock), core::counted(parallel::thread_count(), "thread"), f.cpu, clock_text(f.sample.clock),
            f.sample.size.width, f.sample.size.height, memory);
    const auto range = [&](double value, auto&& text) {
        return range_text(text(value), text(value * (1 - f.spread)), text(value * (1 + f.spread)));
    };
    return fmt::format(
        "Takes about {} on this machine's {}, {:.0f} s of CPU time; the film has about {}.\n"
        "{} Disk while it is made: about {}. From {} lit at {}x{}.\n",
        range(f.clock, clock_text), core::counted(parallel::thread_count(), "thread"), f.cpu,
        range(f.bytes, bytes_text), memory, bytes_text(f.disk), core::counted(f.sample.frames, "frame"),
        f.sample.size.width, f.sample.size.height);
}

}  // namespace render2mpeg::app
