#include "app/loop/chunk_shares.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>

#include "app/loop/forecast.h"
#include "app/loop/observer.h"
#include "app/loop/shots.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Frames of each chunk between cuts, with its index.
std::vector<Chunk> stretches_of(const RenderJob& film) {
    const std::vector<std::int64_t> cuts = cuts_of(film);
    std::vector<Chunk> stretches;
    for (const Chunk& chunk : film.chunks()) {
        stretches.push_back(chunk);
        for (const std::int64_t cut : cuts) {
            if (cut <= chunk.first || cut > chunk.last) continue;
            stretches.back().last = cut - 1;
            stretches.push_back({chunk.index, cut, chunk.last});
        }
    }
    return stretches;
}

/// CPU seconds of each chunk in small pictures. Empty where these take too long, and after an interruption.
std::vector<double> small_costs(const RenderJob& film, bool quiet) {
    // fit: docs/measurements.md#farms, pictures of 32 pixels (32 and 48), 4 frames in the middle of each stretch (2 to
    // 6): a first one, which begins light anew, a P picture and two B pictures. chosen: a thirtieth of the film's time
    // at most.
    constexpr double side = 32, most_share = 1.0 / 30;
    constexpr std::int64_t length = 4;
    const std::vector<Chunk> stretches = stretches_of(film);
    // Time grows about as the sides do.
    const double scale = scale_for(film, side);
    const auto frames = length * std::ssize(stretches);
    if (static_cast<double>(frames) * scale > most_share * static_cast<double>(film.frame_count())) return {};
    RenderJob small = resized(film, scale);
    small.allocations.clear();
    renderer::Renderer renderer = renderer_of(small);
    Progress progress(std::ssize(stretches), quiet, "sample", Counted::parts_of_step);
    std::vector<double> costs(film.chunks().size());
    for (const Chunk& stretch : stretches) {
        const std::int64_t first = stretch.first + std::max<std::int64_t>(0, stretch.frames() - length) / 2;
        LoopObserver nobody;
        RunStatistics statistics;
        const std::optional<FrameSample> sample =
            light_windows(small, renderer, {{0, first, std::min(first + length - 1, stretch.last)}}, nobody, statistics,
                          [] { return !InterruptGuard::requested(); });
        if (!sample) return {};
        costs[static_cast<std::size_t>(stretch.index)] +=
            std::max(1e-6, sample->first.seconds + static_cast<double>(stretch.frames() - 1) * sample->later.seconds);
        progress.advance();
    }
    return costs;
}

}  // namespace

std::vector<double> chunk_shares(const RenderJob& film, bool quiet) {
    std::vector<double> shares = small_costs(film, quiet);
    if (shares.empty())
        for (const Chunk& chunk : film.chunks()) shares.push_back(static_cast<double>(chunk.frames()));
    const double all = std::reduce(shares.begin(), shares.end());
    for (double& share : shares) share /= all;
    return shares;
}

std::vector<ChunkRange> balanced(const std::vector<double>& shares, std::size_t count) {
    EXPECTS(count >= 1 && count <= shares.size());
    std::vector<double> sums(shares.size() + 1);
    std::partial_sum(shares.begin(), shares.end(), sums.begin() + 1);
    // Runs within a bound that the chunks from each one on need.
    std::vector<std::size_t> needed(sums.size());
    const auto fits = [&](double bound) {
        for (std::size_t i = shares.size(), end = i; i-- > 0;) {
            while (end > i + 1 && sums[end] - sums[i] > bound) --end;
            needed[i] = 1 + needed[end];
        }
        return needed[0] <= count;
    };
    const double longest = *std::ranges::max_element(shares);
    double low = 0, high = sums.back() / static_cast<double>(count) + longest;
    // Halve to a millionth.
    for (int i = 0; i < 20; ++i) {
        const double bound = (low + high) / 2;
        (fits(bound) && bound >= longest ? high : low) = bound;
    }
    fits(high);
    // End each run near the mean of what is left, as far as the bound and the runs behind it allow.
    std::vector<ChunkRange> runs;
    for (std::size_t left = count, first = 0; left > 0; --left, first = runs.back().last + 1) {
        std::size_t end = first + 1;
        const double mean = (sums.back() - sums[first]) / static_cast<double>(left);
        const auto may_grow = [&] {
            const double more = sums[end + 1] - sums[first];
            const bool is_nearer = more - mean <= mean - (sums[end] - sums[first]);
            return needed[end] > left - 1 || (more <= high && is_nearer);
        };
        while (shares.size() - end > left - 1 && may_grow()) ++end;
        runs.push_back({first, end - 1});
    }
    return runs;
}

}  // namespace render2mpeg::app
