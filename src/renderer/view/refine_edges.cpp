#include "renderer/view/refine_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/base/allocation.h"
#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {
namespace {

/// Samples of pixels that are looked at again, fewer first.
constexpr int rounds[] = {64, 256};

/// Pixels of strands take so many where they are worth more than half of them, midway from a fourth by ratio.
constexpr double least_of_round = 0.5;

/// By how much luminance is expected to differ about a pixel.
float contrast_at(const core::Plane<core::Tolerance>& pixels, int x, int y) {
    float low = std::numeric_limits<float>::max(), high = 0;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, pixels.height() - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, pixels.width() - 1); ++i) {
            const float expected = pixels.at(i, j).background;
            if (!(expected > 0.0f)) continue;
            low = std::min(low, expected);
            high = std::max(high, expected);
        }
    return std::max(high - low, 0.0f);
}

using PixelCounts = std::array<int, tile_size * tile_size>;

/// Surfaces that each pixel of a tile shows side by side: those that lie behind the same mirrors and panes as its
/// first.
PixelCounts surfaces_of(const GatherTile& tile) {
    PixelCounts count{};
    std::array<std::uint8_t, tile_size * tile_size> path{};
    for (const GatherPoint& p : tile) {
        if (count[p.pixel] == 0) path[p.pixel] = p.path;
        count[p.pixel] += p.path == path[p.pixel] ? 1 : 0;
    }
    return count;
}

/// Error of a pixel of m surfaces and n samples, over that of a straight edge with its neighbours' contrast:
/// sqrt(min(m - 1, sqrt(n)) m / 2). Each of m - 1 edges crosses sqrt(n) of the n strata, and means of m surfaces differ
/// by sqrt(m / 2) less than those of two. docs/measurements.md#edges
float edges_of(int surfaces, int samples) {
    const auto m = static_cast<float>(std::max(surfaces, 2));
    return std::sqrt(std::min(m - 1.0f, std::sqrt(static_cast<float>(samples))) * m / 2.0f);
}

/// A frame that is looked at again.
struct LookingAgain {
    const core::ToleranceMap& tolerance;
    const Strands& strands;
    Allocation allocation;
    int before = 0, samples = 0;  ///< of the round before, and of this one
    bool are_most = false;

    /// Whether edges of a pixel err by more than its tolerance with so many samples.
    bool shows_edges(int n, int x, int y, int surfaces) const {
        const core::Tolerance& here = tolerance.pixels.at(x, y);
        return here.background > 0.0f && edge_error(n) * edges_of(surfaces, n) * contrast_at(tolerance.pixels, x, y) >
                                             here.allows(here.background);
    }
    /// Whether strands are worth more than half of so many.
    bool are_worth(int n, int x, int y) const {
        if (strands.light.empty() || !(strands.of_sample.at(x, y) > 0.0f)) return false;
        const core::Tolerance& here = tolerance.pixels.at(x, y);
        const double allowed = static_cast<double>(here.allows(std::max(strands.light.at(x, y), here.background))) /
                               core::errors_of_noise,
                     needs = samples_for(allowed * allowed, 1, std::pow(1.0 * strands.of_sample.at(x, y), 2));
        return allocation.worth(needs, strands.rays) > least_of_round * n;
    }
};

/// The pixels of a tile in which an edge or strands ask for more than `before` samples, and for no more than `samples`
/// unless these are the most.
bool mark_contrasts(const Frame& seen, std::size_t t, const LookingAgain& again, PixelMarks& marks) {
    const TileArea area = area_of(seen, t);
    const PixelCounts of_tile = surfaces_of(seen.tiles[t]);
    bool any = false;
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; ++x) {
            const int surfaces = of_tile[static_cast<std::size_t>((y % tile_size) * tile_size + x % tile_size)];
            const bool wants = again.shows_edges(again.before, x, y, surfaces) || again.are_worth(again.samples, x, y);
            const bool shows = wants && (again.are_most || !(again.shows_edges(again.samples, x, y, surfaces) ||
                                                             again.are_worth(rounds[1], x, y)));
            marks[static_cast<std::size_t>(y % tile_size)][static_cast<std::size_t>(x % tile_size)] = shows;
            any = any || shows;
        }
    return any;
}

}  // namespace

float edge_error(int samples) {
    // fit: 0.3, within a quarter for 4 to 256 samples (test).
    return 0.3f * strata_error(static_cast<float>(samples));
}

Frame refine_edges(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan,
                   const core::ToleranceMap& tolerance, const Strands& strands, int most_samples, Frame seen,
                   SeeCounts& counts) {
    if (tolerance.is_reference()) return seen;
    int before = std::max(settings.samples, settings.edge_samples);
    if (seen.samples.empty())
        seen.samples = core::Plane<std::uint16_t>(settings.format.width, settings.format.height,
                                                  static_cast<std::uint16_t>(settings.samples));
    const EyePaths paths(posed_scene, settings, plan);
    std::vector<SeeCounts> tile_counts(seen.tiles.size());
    for (const int samples : rounds) {
        if (samples <= before || samples > most_samples) continue;
        const LookingAgain again{tolerance, strands, {tolerance.typical, tolerance.means, 0},
                                 before,    samples, samples == rounds[1] || rounds[1] > most_samples};
        const std::vector<glm::vec2> pattern = sample_pattern(samples);
        const Looking looking{posed_scene.tracer(),
                              paths,
                              posed_scene.posed().camera,
                              pattern,
                              1.0f / std::sqrt(static_cast<float>(samples)),
                              true};
        parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
            PixelMarks marks{};
            if (mark_contrasts(seen, t, again, marks)) look_again(looking, t, marks, seen, tile_counts[t]);
        });
        before = samples;
    }
    for (const SeeCounts& c : tile_counts) counts.add(c);
    counts.sky_seconds += paths.sky_seconds();
    return seen;
}

}  // namespace render2mpeg::renderer
