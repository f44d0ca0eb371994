#pragma once
// Follows light at some instants of a film, to choose anchors.
#include <cstdint>

namespace render2mpeg::renderer {

/// Counts of a film's light paths at the sampled instants.
struct Landings {
    std::uint64_t paths = 0;   ///< followed
    std::uint64_t landed = 0;  ///< VPLs that they left
};

/// Paths that every instant follows so that about `photons` VPLs are left (0: what so many anchors ask for). Bounded
/// to both sides, however few paths were seen to land: at most 64 per anchor (or `photons`, if that is more), and at
/// least as many as leave the VPLs if each path leaves one at every bounce.
std::uint64_t paths_of_anchors(int anchors, std::uint64_t photons, int bounces, Landings seen);

}  // namespace render2mpeg::renderer
