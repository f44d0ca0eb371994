#include "app/loop/film_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/loop/counters.h"
#include "app/loop/pipeline.h"
#include "app/system/interrupt.h"
#include "core/numeric.h"
#include "core/rational.h"

namespace render2mpeg::app {
namespace {

constexpr std::size_t least_frames = 3;

/// Of a light's largest strength: what it changes by from one frame to the next where it comes or goes.
/// chosen: a third; a fade over four frames is none.
constexpr float switched = 1.0f / 3;

/// Bits of pictures of one scene over those of smaller ones grow with this power of their pixels.
/// chosen: by cornell and still_room from 96 to 192 pixels; 0.7 where light is rough (docs/measurements.md#rates).
constexpr double bits_power = 0.80;

/// CPU seconds of passes that make light points and their trees, and of glare, which is mostly the eye's pattern in
/// small pictures: alike at any size of the picture.
double light_seconds(const renderer::Renderer& renderer, const RunStatistics& statistics) {
    using enum renderer::Pass;
    double sum = statistics.pass_seconds[static_cast<std::size_t>(glare)];
    for (const renderer::Pass pass :
         {pose, punctual_lights, emissive_lights, sky_light, whole_lamps, direct_tree, photons, indirect_tree})
        sum += renderer.seconds(pass);
    return sum;
}

/// The frames at which a light's strength is another one.
void add_switches(const RenderJob& film, const scene::Track& track, std::vector<std::int64_t>& frames) {
    std::vector<float> strengths;
    for (std::int64_t n = film.frames.first; n <= film.frames.last; ++n) {
        float value = 0;
        track.sample(core::time_of(n, film.rate).value(), {&value, 1});
        strengths.push_back(std::max(0.0f, value));
    }
    const float largest = *std::max_element(strengths.begin(), strengths.end());
    for (std::size_t i = 1; i < strengths.size(); ++i)
        if (std::abs(strengths[i] - strengths[i - 1]) > switched * largest)
            frames.push_back(film.frames.first + static_cast<std::int64_t>(i));
}

void sort_once(std::vector<std::int64_t>& frames) {
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
}

/// A mean that can be asked of nothing.
struct Mean {
    double sum = 0, count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    double or_else(double instead) const { return core::divide_or(sum, count, instead); }
};

/// One window of the sample, its frames parted into those that follow from others and those that do not.
struct Parted {
    std::vector<double> usual;  ///< seconds
    Mean abrupt;                ///< seconds beyond the usual ones
};

/// Seconds of a window at the film's size: light points take what they take at any size.
std::vector<double> grown_by(const SampleWindow& window, double times) {
    std::vector<double> seconds = window.seconds;
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        const double light = i < window.lights.size() ? std::clamp(window.lights[i], 0.0, seconds[i]) : 0.0;
        seconds[i] = light + (seconds[i] - light) * times;
    }
    return seconds;
}

Parted parted(const SampleWindow& window, double times, const AbruptFrames& abrupt) {
    const std::vector<double> seconds = grown_by(window, times);
    Parted parts;
    std::vector<double> others;
    for (std::size_t i = 0; i < seconds.size(); ++i)
        (i > 0 && abrupt.contains(window.first + static_cast<std::int64_t>(i)) ? others : parts.usual)
            .push_back(seconds[i]);
    // Where hardly anything follows from what was before, that is what is usual.
    if (parts.usual.size() < 2) return {seconds, {}};
    Mean later;
    for (std::size_t i = 1; i < parts.usual.size(); ++i) later.add(parts.usual[i]);
    for (const double other : others) parts.abrupt.add(other - later.or_else(0));
    return parts;
}

/// Groups of pictures, as cuts begin one.
double groups_of(const RenderJob& film, const Chunk& chunk, const AbruptFrames& abrupt) {
    double groups = 0;
    std::int64_t begin = chunk.first;
    const auto add = [&](std::int64_t end) {
        groups += std::ceil(static_cast<double>(end - begin) / static_cast<double>(film.coding.gop));
        begin = end;
    };
    for (const std::int64_t cut : abrupt.cuts)
        if (cut > chunk.first && cut <= chunk.last) add(cut);
    add(chunk.last + 1);
    return groups;
}

double bytes_by(const FilmSample& sample, const RenderJob& film, const AbruptFrames& abrupt) {
    Mean first, later, switching;
    for (const SampleWindow& window : sample.windows)
        for (std::size_t i = 0; i < window.bytes.size(); ++i) {
            const std::int64_t frame = window.first + static_cast<std::int64_t>(i);
            const bool cut = std::binary_search(abrupt.cuts.begin(), abrupt.cuts.end(), frame);
            (i == 0 || cut ? first : abrupt.contains(frame) ? switching : later).add(window.bytes[i]);
        }
    double groups = 0;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop)) groups += groups_of(film, chunk, abrupt);
    const auto switches = static_cast<double>(abrupt.switches.size());
    const double rest = std::max(0.0, static_cast<double>(film.frame_count()) - groups - switches);
    const double whole = first.or_else(0), usual = later.or_else(switching.or_else(whole));
    return groups * whole + switches * switching.or_else(whole) + rest * usual;
}

}  // namespace

bool AbruptFrames::contains(std::int64_t frame) const {
    return std::binary_search(cuts.begin(), cuts.end(), frame) ||
           std::binary_search(switches.begin(), switches.end(), frame);
}

AbruptFrames abrupt_frames(const RenderJob& film) {
    const scene::Animation& scene = *film.animation;
    AbruptFrames abrupt;
    for (const scene::Track& track : scene.tracks)
        if (track.width == 1 &&
            (track.target == scene::TrackTarget::light_intensity || track.target == scene::TrackTarget::emission))
            add_switches(film, track, abrupt.switches);
    int camera = -1;
    for (const scene::Shot& shot : scene.shots) {
        if (shot.frame > film.frames.first && shot.frame <= film.frames.last && shot.camera != camera)
            abrupt.cuts.push_back(shot.frame);
        camera = shot.camera;
    }
    sort_once(abrupt.cuts);
    sort_once(abrupt.switches);
    // What is both is a cut.
    std::erase_if(abrupt.switches, [&](std::int64_t frame) {
        return std::binary_search(abrupt.cuts.begin(), abrupt.cuts.end(), frame);
    });
    return abrupt;
}

int FilmSample::frames() const {
    std::size_t sum = 0;
    for (const SampleWindow& window : windows) sum += window.seconds.size();
    return static_cast<int>(sum);
}

std::optional<FilmSample> light_sample(const RenderJob& job, const std::vector<Chunk>& windows, double limit,
                                       LoopObserver& observer, Progress& progress) {
    FilmSample found;
    const double before_all = cpu_seconds();
    renderer::Renderer renderer = renderer_of(job);
    found.built = cpu_seconds() - before_all;
    const double began = clock_seconds();
    for (const Chunk& chunk : windows) {
        RunStatistics statistics;
        const double before = cpu_seconds();
        double made = light_seconds(renderer, statistics);
        SampleWindow window{chunk.first, {}, {}, {}};
        render_chunk(job, renderer, chunk, observer, statistics, [&] {
            progress.advance();
            window.lights.push_back(light_seconds(renderer, statistics) - made);
            made += window.lights.back();
            // Of the first window so many that there are some behind the first, whatever they take.
            const bool enough = !found.windows.empty() || statistics.frames.size() >= least_frames;
            return !InterruptGuard::requested() && (!enough || clock_seconds() < limit);
        });
        if (InterruptGuard::requested()) return {};
        const double all = cpu_seconds() - before;
        found.statistics = sum_of(found.statistics, statistics);
        found.cpu += all;
        double behind = 0;
        for (const FrameEntry& entry : statistics.frames) {
            if (!window.seconds.empty()) behind += entry.seconds;
            window.seconds.push_back(entry.seconds);
            window.bytes.push_back(static_cast<double>(entry.bytes));
        }
        if (window.seconds.empty()) continue;
        window.seconds.front() = std::max(window.seconds.front(), all - behind);
        found.windows.push_back(std::move(window));
        if (clock_seconds() >= limit) break;
    }
    found.clock = clock_seconds() - began;
    found.statistics = totals_of(found.statistics, renderer);
    return found;
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

std::vector<Chunk> sample_windows(const RenderJob& film, int count, int length, const AbruptFrames& abrupt) {
    const std::int64_t begin = film.frames.first, all = film.frame_count();
    if (all <= count * length) return {{0, film.frames.first, film.frames.last}};
    std::vector<Chunk> windows;
    for (int i = 0; i < count; ++i) {
        // What happens at a part's first frame is its own, too.
        const std::int64_t low = begin + std::max<std::int64_t>(0, i * all / count - 1),
                           high = begin + (i + 1) * all / count - length;
        std::int64_t first = begin + (2 * i + 1) * all / (2 * count) - length / 2;
        const auto distance = [&](std::int64_t to) { return std::abs(to - first); };
        std::optional<std::int64_t> nearest;
        for (const std::vector<std::int64_t>* frames : {&abrupt.cuts, &abrupt.switches})
            for (const std::int64_t frame : *frames) {
                // The least that the window has to move by to have it among its later frames.
                const std::int64_t to = std::clamp(first, frame - length + 1, frame - 1);
                if (to >= low && to <= high && (!nearest || distance(to) < distance(*nearest))) nearest = to;
            }
        first = nearest.value_or(first);
        windows.push_back({i, first, first + length - 1});
    }
    return windows;
}

double chunk_seconds(const std::vector<double>& window, std::int64_t frames) {
    double sum = 0, tail = 0;
    const std::size_t half = window.size() < 3 ? window.size() - 1 : (window.size() + 1) / 2;
    for (std::size_t i = half; i < window.size(); ++i) tail += window[i] / static_cast<double>(window.size() - half);
    for (std::int64_t n = 0; n < frames; ++n)
        sum += static_cast<std::size_t>(n) < window.size() ? window[static_cast<std::size_t>(n)] : tail;
    return sum;
}

SampledFilm film_by(const FilmSample& sample, const RenderJob& film, const RenderJob& sampled,
                    const AbruptFrames& abrupt) {
    const auto pixels = [](const RenderJob& job) { return static_cast<double>(job.format.width) * job.format.height; };
    const double grown = core::divide_or(pixels(film), pixels(sampled), 1.0);
    SampledFilm whole;
    std::vector<Parted> windows;
    Mean surplus;
    double least = 1e30, most = 0;
    for (const SampleWindow& window : sample.windows) {
        windows.push_back(parted(window, grown, abrupt));
        surplus.sum += windows.back().abrupt.sum;
        surplus.count += windows.back().abrupt.count;
        const double mean = chunk_seconds(windows.back().usual, 60);
        least = std::min(least, mean);
        most = std::max(most, mean);
    }
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop))
        for (const Parted& window : windows)
            whole.cpu += chunk_seconds(window.usual, chunk.frames()) / static_cast<double>(windows.size());
    whole.cpu += std::max(0.0, surplus.or_else(0)) * static_cast<double>(abrupt.count());
    whole.first = windows.front().usual.front();
    whole.later = (chunk_seconds(windows.front().usual, 1000) - chunk_seconds(windows.front().usual, 900)) / 100;
    whole.apart = windows.size() < 2 ? 0 : core::divide_or(most - least, most + least, 0.0);
    whole.bytes = bytes_by(sample, film, abrupt) * std::pow(grown, bits_power);
    return whole;
}

}  // namespace render2mpeg::app
