#include "app/estimate/chunk_shares.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "app/job/shots.h"
#include "app/loop/sample.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// CPU seconds of each chunk in small pictures. Empty where these take too long, and after an interruption.
std::vector<double> seconds_of_chunks(const RenderJob& film, bool quiet) {
    // fit: docs/measurements.md#farms, 4 frames in the middle of each stretch (2 to 6): a first one, which begins light
    // anew, a P picture and two B pictures.
    constexpr int length = 4;
    const std::vector<Chunk> stretches = stretches_of(film, film.chunks());
    const std::vector<WindowCost> costs =
        small_costs(film, stretches, length, film.frame_count(), quiet,
                    [](const RenderJob& small) { return std::make_unique<renderer::Renderer>(renderer_of(small)); });
    if (costs.empty()) return {};
    std::vector<double> seconds(film.chunks().size());
    for (std::size_t k = 0; k < stretches.size(); ++k)
        seconds[static_cast<std::size_t>(stretches[k].index)] += std::max(
            1e-6, costs[k].first.seconds + static_cast<double>(stretches[k].frames() - 1) * costs[k].later.seconds);
    return seconds;
}

}  // namespace

std::vector<double> chunk_shares(const RenderJob& film, bool quiet) {
    std::vector<double> shares = seconds_of_chunks(film, quiet);
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
