#include "app/loop/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "app/files/container_share.h"
#include "app/loop/film_sample.h"
#include "app/loop/memory_need.h"
#include "app/options/chunk.h"
#include "app/system/interrupt.h"
#include "app/system/probes.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "core/text.h"
#include "parallel/loops.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// The longest windows that are tried, and how many. chosen: two, at a fourth and at three fourths, tell whether its
/// frames are alike; 15 are a usual group of pictures, 3 the least that has frames behind the first. Where light
/// changes from one frame to the next more of them are worth more than longer ones.
constexpr int windows = 2, windows_of_abrupt = 4;
constexpr int lengths[] = {15, 9, 5, 3};

/// Sides below which a picture has little in common with a large one.
constexpr int least_side = 96;

/// Of the time, what frames may be planned to take: the first look, and what is misjudged, take the rest.
constexpr double planned_share = 0.9;

/// Of the time, what frames get whatever was settled before took. chosen: a fourth lights three small frames.
constexpr double least_share = 0.25;

/// What a first pass takes of the film's time. chosen: a sixteenth of the pixels, roughly lit.
constexpr double first_pass_share = 0.05;

double pixels_of(const RenderJob& film) {
    return static_cast<double>(film.format.width) * film.format.height;
}

/// What a sample is to be: windows, frames of each, and how large.
struct SampleSize {
    int count = 1, length = 5;
    double scale = 1;
};

/// The longest windows at the film's size that fit into `seconds` on the clock, or smaller pictures. `frame`: seconds
/// on the clock of a frame of the film, about; `start`: what a chunk's first frame takes more. `most`: windows.
SampleSize sample_for(const RenderJob& film, int most, double frame, double start, double seconds) {
    for (const int count : {most, windows, 1})
        for (const int length : lengths) {
            if (count > windows && length > lengths[2]) continue;
            if (count * (start + length * frame) <= seconds) return {count, length, 1};
        }
    const double largest = std::max(film.format.width, film.format.height);
    const double area = core::divide_or(std::max(0.0, seconds - start), lengths[2] * frame, 1.0);
    return {1, lengths[2], std::clamp(std::sqrt(area), std::min(1.0, least_side / largest), 1.0)};
}

/// Settles what a film is lit by before its first frame. Whether nobody interrupted.
bool settle(RenderJob& film) {
    if (!probe_images(*film.animation, image_probes(false))) return false;
    if (!film.exposure) film.exposure = measure_exposure(film);
    return !InterruptGuard::requested();
}

std::string clock_range(double seconds, double spread) {
    return fmt::format("{} ({} to {})", clock_text(seconds), clock_text(seconds * (1 - spread)),
                       clock_text(seconds * (1 + spread)));
}

std::string bytes_text(double bytes) {
    return bytes < 1e6 ? fmt::format("{:.0f} kB", 1e-3 * bytes) : fmt::format("{:.3g} MB", 1e-6 * bytes);
}

}  // namespace

std::optional<FilmEstimate> estimate_film(RenderJob& film, const std::filesystem::path& output, double within,
                                          bool quiet) {
    const double began = clock_seconds(), cpu_before = cpu_seconds();
    if (!settle(film)) return {};
    const double once = cpu_seconds() - cpu_before;

    // A first look at small frames tells how many of the film's own there is time for.
    const double largest = std::max(film.format.width, film.format.height);
    const RenderJob tiny = resized(film, std::min(1.0, least_side / largest));
    // What is settled first is needed by the film, whatever it takes; frames get a part of the time at least.
    const double end = std::max(began + within, clock_seconds() + least_share * within), left = end - clock_seconds();
    const AbruptFrames abrupt = abrupt_frames(film);
    LoopObserver nobody;
    Progress looking(lengths[3], quiet, "sample", Counted::parts_of_step);
    const auto look =
        light_sample(tiny, sample_windows(film, 1, lengths[3], {}), clock_seconds() + 0.3 * left, nobody, looking);
    if (!look || look->windows.empty()) return {};
    const SampledFilm seen = film_by(*look, film, tiny, {});
    const double pace = core::divide_or(look->clock, look->cpu, 1.0);
    const SampleSize sample = sample_for(film, abrupt.count() > 0 ? windows_of_abrupt : windows, pace * seen.later,
                                         pace * std::max(0.0, seen.first - seen.later),
                                         planned_share * std::max(0.1 * within, end - clock_seconds()));

    // Where the first look took all of the time, it is the sample.
    const bool over = clock_seconds() >= end;
    const RenderJob job = over ? tiny : resized(film, sample.scale);
    const std::vector<Chunk> chunks = sample_windows(film, sample.count, sample.length, abrupt);
    const auto frames = static_cast<std::int64_t>(chunks.size()) * chunks.front().frames();
    Progress progress(frames, quiet || over, "sample", Counted::frames_of_step);
    const auto found = over ? look : light_sample(job, chunks, end, nobody, progress);
    if (!found || found->windows.empty()) return {};

    const SampledFilm whole = film_by(*found, film, job, abrupt);
    FilmEstimate estimate;
    estimate.frames = found->frames();
    estimate.size = {job.format.width, job.format.height};
    estimate.sample = found->statistics;
    estimate.first = whole.first;
    estimate.later = whole.later;
    estimate.cpu = whole.cpu * (film.two_passes ? 1 + first_pass_share : 1) + once + found->built + cpu_before;
    estimate.clock = estimate.cpu * core::divide_or(found->clock, found->cpu, 1.0);
    if (film.kind == OutputKind::film) {
        const std::int64_t rate = film.coding.rate_control.bit_rate;
        const double seconds = static_cast<double>(film.frame_count()) / film.rate.hertz.value();
        estimate.bytes = file_of_pictures(rate > 0 ? static_cast<double>(rate) / 8 * seconds : whole.bytes,
                                          film.frame_count(), output, film.disc);
    }
    // chosen: a tenth where windows are alike; what they differ by, and as much again for other sizes.
    const bool smaller = pixels_of(job) < 0.99 * pixels_of(film);
    estimate.spread = std::min(0.5, std::max(0.1, whole.apart) + (smaller ? 0.1 : 0.0));
    estimate.memory = memory_need(film).total();
    return estimate;
}

std::string film_text(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    const scene::Traits traits = scene::traits_of(scene);
    int camera = 0;
    for (const scene::Shot& shot : scene.shots)
        if (shot.frame <= film.frames.first) camera = shot.camera;
    std::string lights;
    const auto add = [&](const std::string& text) { lights += (lights.empty() ? "" : ", ") + text; };
    if (!scene.lights.empty()) add(fmt::format("{} lamp{}", scene.lights.size(), scene.lights.size() == 1 ? "" : "s"));
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

std::string text_of(const FilmEstimate& e) {
    std::string text = fmt::format("Takes about {} on this machine's {} thread{}, {:.0f} s of CPU time",
                                   clock_range(e.clock, e.spread), parallel::thread_count(),
                                   parallel::thread_count() == 1 ? "" : "s", e.cpu);
    if (e.bytes > 0)
        text += fmt::format("; the film has about {} ({} to {})", bytes_text(e.bytes),
                            bytes_text(e.bytes * (1 - e.spread)), bytes_text(e.bytes * (1 + e.spread)));
    text += fmt::format(".\nMemory: about {:.0f} MiB. ", static_cast<double>(e.memory) / (1 << 20));
    if (e.bytes > 0) text += fmt::format("Disk while it is made: about {}. ", bytes_text(2 * e.bytes));
    return text + fmt::format("From {} frames lit at {}x{}.\n", e.frames, e.size.width, e.size.height);
}

}  // namespace render2mpeg::app
