#pragma once
// Counts of lighting hair.
#include <cstdint>

namespace render2mpeg::renderer {

/// Sums over frames.
struct HairCounts {
    std::uint64_t rays = 0, pixels = 0;
    std::uint64_t samples = 0;  ///< lit, each round of them
    std::uint64_t capped = 0;   ///< pixels whose tolerance asks for more rays than there may be

    void add(const HairCounts& more) {
        rays += more.rays;
        pixels += more.pixels;
        samples += more.samples;
        capped += more.capped;
    }
};

}  // namespace render2mpeg::renderer
