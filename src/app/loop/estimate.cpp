#include "app/loop/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/files/container_share.h"
#include "app/loop/light_budget.h"
#include "app/loop/memory_need.h"
#include "app/loop/pipeline.h"
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

/// Windows of the film, and their longest lengths. chosen: two, at a fourth and at three fourths, tell whether its
/// frames are alike; 15 are a usual group of pictures, 3 the least that has frames behind the first.
constexpr int windows = 2;
constexpr int lengths[] = {15, 9, 5, 3};

constexpr std::size_t least_frames = 3;

/// Sides below which a picture has little in common with a large one.
constexpr int least_side = 96;

/// Of the time, what frames may be planned to take: the first look, and what is misjudged, take the rest.
constexpr double planned_share = 0.9;

/// Bits of pictures of one scene over those of smaller ones grow with this power of their pixels.
/// chosen: by cornell and still_room from 96 to 192 pixels; 0.7 where light is rough (docs/fits/rate-model.md).
constexpr double bits_power = 0.80;

/// What a first pass takes of the film's time. chosen: a sixteenth of the pixels, roughly lit.
constexpr double first_pass_share = 0.05;

/// The film at a smaller size.
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

double pixels_of(const RenderJob& film) {
    return static_cast<double>(film.format.width) * film.format.height;
}

/// What windows of one size took.
struct Measured {
    /// CPU, of each window's frames; the first with what begins a chunk.
    std::vector<std::vector<double>> seconds;
    std::vector<std::vector<double>> lights;  ///< of these: what does not depend on the picture's size
    double all = 0;
    double clock = 0;
    double first_bytes = 0, later_bytes = 0;  ///< means
    int frames = 0;
    double built = 0;  ///< CPU to build what never changes
    bool kept = false;
    RunStatistics statistics;  ///< CPU by stage and by row of the plan
};

/// CPU seconds of passes that make light points and their trees: alike at any size of the picture.
double light_seconds(const renderer::Renderer& renderer) {
    using enum renderer::Pass;
    double sum = 0;
    for (const renderer::Pass pass :
         {pose, punctual_lights, emissive_lights, sky_light, whole_lamps, direct_tree, photons, indirect_tree})
        sum += renderer.seconds(pass);
    return sum;
}

/// Lights and codes the windows. None where it was interrupted; fewer frames where `limit` (clock_seconds()) passes.
std::optional<Measured> measure(const RenderJob& job, const std::vector<Chunk>& chunks, double limit,
                                Progress& progress) {
    Measured found;
    const double before_all = cpu_seconds();
    renderer::Renderer renderer = renderer_of(job);
    found.built = cpu_seconds() - before_all;
    const double began = clock_seconds();
    double first_bytes = 0, later_bytes = 0;
    int later = 0;
    for (const Chunk& chunk : chunks) {
        RunStatistics statistics;
        LoopObserver nobody;
        const double before = cpu_seconds();
        double made = light_seconds(renderer);
        std::vector<double> lights;
        render_chunk(job, renderer, chunk, nobody, statistics, [&] {
            progress.advance();
            lights.push_back(light_seconds(renderer) - made);
            made += lights.back();
            // Of the first window so many that there are some behind the first, whatever they take.
            const bool enough = !found.seconds.empty() || statistics.frames.size() >= least_frames;
            return !InterruptGuard::requested() && (!enough || clock_seconds() < limit);
        });
        if (InterruptGuard::requested()) return {};
        const double all = cpu_seconds() - before;
        for (std::size_t i = 0; i < statistics.seconds.size(); ++i)
            found.statistics.seconds[i] += statistics.seconds[i];
        for (std::size_t i = 0; i < statistics.pass_seconds.size(); ++i)
            found.statistics.pass_seconds[i] += statistics.pass_seconds[i];
        found.all += all;
        std::vector<double> seconds;
        double behind = 0;
        for (const FrameEntry& entry : statistics.frames) {
            seconds.push_back(entry.seconds);
            if (seconds.size() > 1) behind += entry.seconds;
            (seconds.size() == 1 ? first_bytes : later_bytes) += static_cast<double>(entry.bytes);
            later += seconds.size() > 1 ? 1 : 0;
        }
        if (seconds.empty()) continue;
        seconds.front() = std::max(seconds.front(), all - behind);
        found.frames += static_cast<int>(seconds.size());
        found.seconds.push_back(std::move(seconds));
        found.lights.push_back(std::move(lights));
        found.kept = found.kept || kept_records(job.rendering, renderer.statistics());
        if (clock_seconds() >= limit) break;
    }
    found.clock = clock_seconds() - began;
    for (std::size_t i = 0; i < found.statistics.pass_seconds.size(); ++i)
        found.statistics.pass_seconds[i] += renderer.seconds(static_cast<renderer::Pass>(i));
    for (const auto& [pass, stage] :
         {std::pair{renderer::Pass::develop, Stage::develop}, {renderer::Pass::encode, Stage::encode}})
        found.statistics.pass_seconds[static_cast<std::size_t>(pass)] = found.statistics.stage_seconds(stage);
    found.first_bytes = core::divide_or(first_bytes, static_cast<double>(found.seconds.size()), 0.0);
    found.later_bytes = core::divide_or(later_bytes, static_cast<double>(later), found.first_bytes);
    return found;
}

/// Seconds of pictures with so many times the pixels: light points take what they take at any size.
std::vector<std::vector<double>> grown_by(const Measured& found, double times) {
    std::vector<std::vector<double>> sized = found.seconds;
    for (std::size_t w = 0; w < sized.size(); ++w)
        for (std::size_t i = 0; i < sized[w].size(); ++i) {
            const double light = i < found.lights[w].size() ? std::clamp(found.lights[w][i], 0.0, sized[w][i]) : 0.0;
            sized[w][i] = light + (sized[w][i] - light) * times;
        }
    return sized;
}

/// The middles of equal parts of the film, at most its frames.
std::vector<Chunk> middles(const FrameRange& film, int count, int length) {
    const std::int64_t all = film.last - film.first + 1;
    if (all <= count * length) return {{0, film.first, film.last}};
    std::vector<Chunk> chunks;
    for (int i = 0; i < count; ++i) {
        const std::int64_t first = film.first + (2 * i + 1) * all / (2 * count) - length / 2;
        chunks.push_back({i, first, first + length - 1});
    }
    return chunks;
}

/// What a sample is to be: windows, frames of each, and how large.
struct SampleSize {
    int count = 1, length = 5;
    double scale = 1;
};

/// The longest windows at the film's size that fit into `seconds` on the clock, or smaller pictures. `frame`: seconds
/// on the clock of a frame of the film, about; `start`: what a chunk's first frame takes more.
SampleSize sample_for(const RenderJob& film, double frame, double start, double seconds) {
    for (const int count : {windows, 1})
        for (const int length : lengths)
            if (count * (start + length * frame) <= seconds) return {count, length, 1};
    const double largest = std::max(film.format.width, film.format.height);
    const double area = core::divide_or(std::max(0.0, seconds - start), lengths[2] * frame, 1.0);
    return {1, lengths[2], std::clamp(std::sqrt(area), std::min(1.0, least_side / largest), 1.0)};
}

/// How far apart windows are: half of the difference of their later frames over the sum.
double difference_of(const std::vector<std::vector<double>>& seconds) {
    double least = 1e30, most = 0;
    for (const auto& window : seconds) {
        const double mean = chunk_seconds(window, 60) / 60;
        least = std::min(least, mean);
        most = std::max(most, mean);
    }
    return seconds.size() < 2 ? 0 : core::divide_or(most - least, most + least, 0.0);
}

/// Settles what a film is lit by before its first frame. Whether nobody interrupted.
bool settle(RenderJob& film, bool quiet) {
    if (!probe_images(*film.animation, image_probes(false))) return false;
    if (!film.exposure) film.exposure = measure_exposure(film);
    if (InterruptGuard::requested()) return false;
    if (has_budget(film) && !film.budget) {
        film.budget = measure_light(film, quiet);
        if (!film.budget) return false;
        spend(film, *film.budget);
    }
    return true;
}

std::string clock_range(double seconds, double spread) {
    return fmt::format("{} ({} to {})", clock_text(seconds), clock_text(seconds * (1 - spread)),
                       clock_text(seconds * (1 + spread)));
}

std::string bytes_text(double bytes) {
    return bytes < 1e6 ? fmt::format("{:.0f} kB", 1e-3 * bytes) : fmt::format("{:.3g} MB", 1e-6 * bytes);
}

}  // namespace

double chunk_seconds(const std::vector<double>& window, std::int64_t frames) {
    double sum = 0, tail = 0;
    const std::size_t half = window.size() < 3 ? window.size() - 1 : (window.size() + 1) / 2;
    for (std::size_t i = half; i < window.size(); ++i) tail += window[i] / static_cast<double>(window.size() - half);
    for (std::int64_t n = 0; n < frames; ++n)
        sum += static_cast<std::size_t>(n) < window.size() ? window[static_cast<std::size_t>(n)] : tail;
    return sum;
}

std::optional<FilmEstimate> estimate_film(RenderJob& film, const std::filesystem::path& output, double within,
                                          bool quiet) {
    const double began = clock_seconds(), cpu_before = cpu_seconds();
    if (!settle(film, quiet)) return {};
    const double once = cpu_seconds() - cpu_before;

    // A first look at small frames tells how many of the film's own there is time for.
    const double largest = std::max(film.format.width, film.format.height);
    const RenderJob tiny = resized(film, std::min(1.0, least_side / largest));
    // What is settled first is needed by the film, whatever it takes; frames get four fifths of the time at least.
    const double end = std::max(began + within, clock_seconds() + 0.8 * within), left = end - clock_seconds();
    Progress looking(2, quiet, "sample", Counted::parts_of_step);
    const auto look = measure(tiny, middles(film.frames, 1, 2), clock_seconds() + 0.3 * left, looking);
    if (!look || look->seconds.empty()) return {};
    const double ratio = core::divide_or(pixels_of(film), pixels_of(tiny), 1.0);
    const std::vector<double> sized_look = grown_by(*look, ratio).front();
    const double pace = core::divide_or(look->clock, look->all, 1.0);
    const SampleSize sample =
        sample_for(film, pace * sized_look.back(), pace * std::max(0.0, sized_look.front() - sized_look.back()),
                   planned_share * std::max(1.0, end - clock_seconds()));

    const RenderJob job = sample.scale < 1 ? resized(film, sample.scale) : resized(film, 1);
    const std::vector<Chunk> chunks = middles(film.frames, sample.count, sample.length);
    const auto frames = static_cast<std::int64_t>(chunks.size()) * chunks.front().frames();
    Progress progress(frames, quiet, "sample", Counted::frames_of_step);
    const auto found = measure(job, chunks, end + 0.2 * within, progress);
    if (!found || found->seconds.empty()) return {};

    FilmEstimate estimate;
    estimate.frames = found->frames;
    estimate.size = {job.format.width, job.format.height};
    estimate.kept_records = found->kept;
    estimate.sample = found->statistics;
    const double grown = core::divide_or(pixels_of(film), pixels_of(job), 1.0);
    const std::vector<std::vector<double>> sized = grown_by(*found, grown);
    const std::vector<Chunk> all = chunks_of(film.frames, film.coding.gop);
    for (const Chunk& chunk : all)
        for (const std::vector<double>& window : sized)
            estimate.cpu += chunk_seconds(window, chunk.frames()) / static_cast<double>(sized.size());
    estimate.first = sized.front().front();
    estimate.later = (chunk_seconds(sized.front(), 1000) - chunk_seconds(sized.front(), 900)) / 100;
    if (film.two_passes) estimate.cpu *= 1 + first_pass_share;
    estimate.cpu += once + found->built + cpu_before;
    estimate.clock = estimate.cpu * core::divide_or(found->clock, found->all, 1.0);
    if (film.kind == OutputKind::film) {
        const auto count = static_cast<double>(film.frame_count());
        double groups = 0;
        for (const Chunk& chunk : all)
            groups += std::ceil(static_cast<double>(chunk.frames()) / static_cast<double>(film.coding.gop));
        const double bits = groups * found->first_bytes + (count - groups) * found->later_bytes;
        const std::int64_t rate = film.coding.rate_control.bit_rate;
        const double pictures = rate > 0 ? static_cast<double>(rate) / 8 * count / film.rate.hertz.value()
                                         : bits * std::pow(grown, bits_power);
        estimate.bytes = file_of_pictures(pictures, film.frame_count(), output, film.disc);
    }
    // chosen: a tenth where windows are alike; what they differ by, and as much again for other sizes.
    estimate.spread = std::min(0.5, std::max(0.1, difference_of(found->seconds)) + (grown > 1.01 ? 0.1 : 0.0));
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

std::string text_of(const RenderJob& film, const FilmEstimate& e) {
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
