#include "renderer/lights/anchor_paths.h"

#include <algorithm>

namespace render2mpeg::renderer {
namespace {

/// VPLs that are spread in a frame for this many anchors: 32 for each, since a moving lamp should change them by its
/// motion and not by noise. From 4,096 anchors on their noise is small in sum: no more than 131,072, but 8 for each,
/// and of these no more than 524,288, but 2.
std::uint64_t photons_for(std::uint64_t anchors) {
    const std::uint64_t few = std::min<std::uint64_t>(32 * anchors, 1u << 17),
                        some = std::min<std::uint64_t>(8 * anchors, 1u << 19);
    return std::max({few, some, 2 * anchors});
}

/// Paths that an instant follows at most, for each anchor: a bound on the time of scenes whose light mostly meets
/// nothing. chosen: 64, twice what a scene takes whose paths leave one VPL each.
constexpr std::uint64_t most_paths_per_anchor = 64;

/// VPLs that one path leaves on the average at most (largest_albedo).
constexpr std::uint64_t most_landings = 100;

}  // namespace

std::uint64_t paths_of_anchors(int anchors, std::uint64_t photons, int bounces, Landings seen) {
    const auto count = static_cast<std::uint64_t>(std::max(anchors, 1));
    const std::uint64_t most = std::max(most_paths_per_anchor * count, photons);
    if (photons == 0) photons = photons_for(count);
    const std::uint64_t landings = bounces > 0 ? static_cast<std::uint64_t>(bounces) : most_landings;
    const std::uint64_t least = std::max<std::uint64_t>(photons / landings, 1);
    // None seen to land is no reason to follow none: light may come later.
    const double per_landing =
        seen.landed == 0 ? 1.0 : static_cast<double>(seen.paths) / static_cast<double>(seen.landed);
    const double needed = std::min(static_cast<double>(photons) * per_landing, static_cast<double>(most));
    return std::clamp(static_cast<std::uint64_t>(needed), std::min(least, most), most);
}

}  // namespace render2mpeg::renderer
