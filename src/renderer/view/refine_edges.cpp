#include "renderer/view/refine_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "parallel/loops.h"
#include "renderer/base/allocation.h"
#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {
namespace {

/// Samples of pixels that are looked at again, fewer first.
constexpr int rounds[] = {64, 256};

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

/// Standard error of a pixel that shows strands, over its luminance and the root of one over its samples: each shows
/// another strand, lit by itself. chosen: 0.6 of 0.4 to 0.8; clear and brown fur have 0.3 and 0.4, dark hair before
/// skin has 2.
constexpr float strands_differ = 0.6f;

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

/// Standard error of a pixel's edges and strands.
float error_of(int samples, int surfaces, float contrast, float strands) {
    return std::max(edge_error(samples) * edges_of(surfaces, samples) * contrast,
                    strands_differ / std::sqrt(static_cast<float>(samples)) * strands);
}

/// The pixels of a tile in which an edge or strands show by more than their tolerance with `before` samples, and by
/// less with `samples`, unless these are the most.
bool mark_contrasts(const Frame& seen, std::size_t t, const core::ToleranceMap& tolerance, int before, int samples,
                    bool are_most, PixelMarks& marks) {
    const TileArea area = area_of(seen, t);
    const PixelCounts surfaces = surfaces_of(seen.tiles[t]);
    std::array<bool, tile_size * tile_size> strands{};
    if (!seen.fibres.empty())
        for (const FibreSample& f : seen.fibres[t]) strands[f.pixel] = strands[f.pixel] || !f.below;
    bool any = false;
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; ++x) {
            const core::Tolerance& here = tolerance.pixels.at(x, y);
            const auto k = static_cast<std::size_t>((y % tile_size) * tile_size + x % tile_size);
            const float contrast = contrast_at(tolerance.pixels, x, y), hair = strands[k] ? here.background : 0.0f,
                        allowed = here.allows(here.background);
            const bool shows = here.background > 0.0f && error_of(before, surfaces[k], contrast, hair) > allowed &&
                               (are_most || error_of(samples, surfaces[k], contrast, hair) <= allowed);
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
                   const core::ToleranceMap& tolerance, int most_samples, Frame seen, SeeCounts& counts) {
    if (tolerance.is_reference()) return seen;
    int before = std::max(settings.samples, settings.edge_samples);
    if (seen.samples.empty())
        seen.samples = core::Plane<std::uint16_t>(settings.format.width, settings.format.height,
                                                  static_cast<std::uint16_t>(settings.samples));
    const EyePaths paths(posed_scene, settings, plan);
    std::vector<SeeCounts> tile_counts(seen.tiles.size());
    for (const int samples : rounds) {
        if (samples <= before || samples > most_samples) continue;
        const bool are_most = samples == rounds[1] || rounds[1] > most_samples;
        const std::vector<glm::vec2> pattern = sample_pattern(samples);
        const Looking looking{posed_scene.tracer(),
                              paths,
                              posed_scene.posed().camera,
                              pattern,
                              1.0f / std::sqrt(static_cast<float>(samples)),
                              true};
        parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
            PixelMarks marks{};
            if (mark_contrasts(seen, t, tolerance, before, samples, are_most, marks))
                look_again(looking, t, marks, seen, tile_counts[t]);
        });
        before = samples;
    }
    for (const SeeCounts& c : tile_counts) counts.add(c);
    counts.sky_seconds += paths.sky_seconds();
    return seen;
}

}  // namespace render2mpeg::renderer
