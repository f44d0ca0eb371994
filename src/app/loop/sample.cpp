#include "app/loop/sample.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "app/loop/pipeline.h"
#include "app/options/shape.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Of pictures that are predicted, how many are P pictures; windows end before their longest runs of B pictures do.
/// fit: a third in eleven films of animations/, two in five in their windows.
constexpr double p_share = 0.27, p_share_weight = 6;

/// Later frames of a window over its first, where none was lit in time. fit: bench/fits/forecast.jsonl (median 0.75,
/// 0.17 to 1.07; bytes 0.19, 0.04 to 0.45)
constexpr double later_over_first = 0.7, later_bytes_over_first = 0.2;

/// A mean with a default.
struct Mean {
    double sum = 0, count = 0;
    void add(double value, double weight = 1) {
        sum += weight * value;
        count += weight;
    }
    double or_else(double instead) const { return core::divide_or(sum, count, instead); }
};

/// Mean cost of several frames.
struct MeanCost {
    Mean seconds, bytes;
    void add(const FrameCost& cost, double weight = 1) {
        seconds.add(cost.seconds, weight);
        bytes.add(cost.bytes, weight);
    }
    FrameCost value() const { return {seconds.or_else(0), bytes.or_else(0)}; }
};

/// Mean cost of the frames but `firsts`, by the film's shares of P and B pictures.
FrameCost later_of(std::span<const FrameEntry> frames, const std::vector<std::int64_t>& firsts) {
    MeanCost kinds[2], all;  // of P pictures, and of B pictures or what is not coded
    for (const FrameEntry& entry : frames) {
        if (std::ranges::find(firsts, entry.frame) != firsts.end()) continue;
        const int kind = entry.type == 'P' || entry.type == 'I' ? 0 : 1;
        kinds[kind].add({entry.cost.seconds, static_cast<double>(entry.bytes)});
    }
    const double p = kinds[0].seconds.count, b = kinds[1].seconds.count;
    if (p == 0 || b == 0) return kinds[p == 0 ? 1 : 0].value();
    const double share = (p_share * p_share_weight + p) / (p_share_weight + p + b);
    all.add(kinds[0].value(), share);
    all.add(kinds[1].value(), 1 - share);
    return all.value();
}

/// Cost of a window whose frames these are.
WindowCost cost_of(const Chunk& window, std::span<const FrameEntry> frames, double first, double cpu,
                   std::vector<std::int64_t> cuts) {
    WindowCost cost{{first, static_cast<double>(frames.front().bytes)}, {}, std::ssize(frames), cpu};
    cuts.push_back(window.first);
    if (cost.frames > 1)
        cost.later = later_of(frames, cuts);
    else if (window.frames() > 1)
        cost.later = {later_over_first * cost.first.seconds, later_bytes_over_first * cost.first.bytes};
    else
        cost.later = cost.first;
    return cost;
}

/// Sides of small pictures, and their share of the film's time. fit: docs/measurements.md#farms, 32 pixels (32 and 48).
/// chosen: a thirtieth at most; a film of several minutes loses a hundredth of that.
constexpr double small_side = 32, most_share = 1.0 / 30;

}  // namespace

double scale_for(const RenderJob& film, double side) {
    return scale_taken(film.size(), side / std::max(film.format.width, film.format.height), film.codec());
}

RenderJob resized(const RenderJob& film, double scale) {
    RenderJob job = film;
    job.resize(scaled(film.size(), scale, film.codec()));
    job.audit = 0;
    job.two_passes = false;
    job.allocations.clear();
    return job;
}

std::optional<FrameSample> light_sample(const Sample& sample, renderer::Renderer& renderer, LoopObserver& observer,
                                        const std::function<bool()>& frame_done, const std::function<bool()>& stops) {
    RenderJob film = sample.film;
    film.is_sample = true;
    FrameSample found;
    found.size = film.size();
    found.codec = film.coding.codec;
    const std::vector<std::int64_t> cuts = cuts_of(film);
    const double began = clock_seconds(), cpu_before = cpu_seconds();
    RunStatistics statistics;
    MeanCost first, later;
    for (std::size_t k = 0; k < sample.windows.all.size() && (k == 0 || !stops()); ++k) {
        const Chunk& window = sample.windows.all[k];
        // It owes the next window nothing of a decoder's buffer.
        film.frames = {window.first, window.last};
        const std::size_t before = statistics.frames.size();
        const double start = cpu_seconds();
        double first_seconds = 0;
        bool goes_on = true;
        render_chunk(
            film, renderer, window, observer, statistics,
            [&] {
                if (statistics.frames.size() == before + 1) first_seconds = cpu_seconds() - start;
                return goes_on = frame_done();
            },
            stops);
        if (!goes_on || InterruptGuard::requested()) return {};
        const std::span frames = std::span(statistics.frames).subspan(before);
        if (frames.empty()) break;  // `stops` ended its first frame
        const WindowCost cost = cost_of(window, frames, first_seconds, cpu_seconds() - start, cuts);
        first.add(cost.first);
        later.add(cost.later, sample.windows.weights.empty() ? 1 : sample.windows.weights[k]);
        found.frames += static_cast<int>(cost.frames);
        found.windows.push_back(cost);
    }
    found.cpu = cpu_seconds() - cpu_before;
    found.clock = clock_seconds() - began;
    found.first = first.value();
    found.later = later.value();
    found.statistics = totals_of(statistics, renderer);
    return found;
}

std::optional<FrameSample> sample_frames(const Sample& sample, LoopObserver& observer, Progress& progress,
                                         const std::function<bool()>& is_over) {
    const double cpu_before = cpu_seconds();
    renderer::Renderer renderer = renderer_of(sample.film);
    const double built = cpu_seconds() - cpu_before;
    std::optional<FrameSample> found = light_sample(sample, renderer, observer, advancing(progress),
                                                    [&] { return InterruptGuard::requested() || is_over(); });
    if (found) found->built = built;
    return found;
}

std::vector<WindowCost> small_costs(const RenderJob& film, const std::vector<Chunk>& stretches, int length,
                                    std::int64_t frames, bool quiet,
                                    const std::function<std::unique_ptr<renderer::Renderer>(const RenderJob&)>& make) {
    // Time grows about as the sides do.
    const double scale = scale_for(film, small_side);
    if (static_cast<double>(length * std::ssize(stretches)) * scale > most_share * static_cast<double>(frames))
        return {};
    const Sample sample{resized(film, scale), {middles_of(stretches, length), {}}};
    const std::unique_ptr<renderer::Renderer> renderer = make(sample.film);
    Progress progress(sample.windows.frames(), quiet, "sample", Counted::parts_of_step);
    LoopObserver nobody;
    const std::optional<FrameSample> found = light_sample(sample, *renderer, nobody, advancing(progress));
    // A signal ends it between two windows, too.
    return found && found->windows.size() == stretches.size() ? found->windows : std::vector<WindowCost>();
}

std::vector<double> prices_of(const RenderJob& film, std::int64_t frames, renderer::Renderer& renderer) {
    // chosen: two frames of each camera, by which shots' times are in proportion to a fifth or so.
    constexpr int length = 2;
    std::map<int, std::size_t> of_cameras;
    std::vector<Chunk> firsts;
    const std::vector<Chunk> shots = stretches_of(film, {{0, film.frames.first, film.frames.last}});
    if (shots.size() == 1) return {};
    for (const Chunk& shot : shots)
        if (of_cameras.emplace(camera_at(film, shot.first), firsts.size()).second) firsts.push_back(shot);
    const std::vector<WindowCost> costs = small_costs(film, firsts, length, frames, true, [&](const RenderJob& small) {
        std::unique_ptr<renderer::Renderer> own = renderer.beside(film.snapshot(film.frames.first));
        own->resize(small.rendering.format);
        return own;
    });
    if (costs.empty()) return {};
    std::vector<double> prices;
    for (const Chunk& shot : shots) {
        const WindowCost& cost = costs[of_cameras.at(camera_at(film, shot.first))];
        prices.resize(static_cast<std::size_t>(shot.last + 1 - film.frames.first),
                      std::max(cost.cpu / static_cast<double>(cost.frames), 1e-6));
    }
    return prices;
}

}  // namespace render2mpeg::app
