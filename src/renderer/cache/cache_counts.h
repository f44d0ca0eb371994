#pragma once
// Counts of the irradiance cache.
#include <algorithm>
#include <cstdint>

namespace render2mpeg::renderer {

/// Counts of the irradiance cache.
struct CacheCounts {
    std::uint64_t created = 0;  ///< records
    std::uint64_t known = 0;    ///< records of earlier runs that were taken
    std::uint64_t served = 0;   ///< gather points lit by records, or as the very same point before
    std::uint64_t most = 0;     ///< records held at a time
    std::uint64_t live = 0;     ///< records held after the last frame

    /// Those of later frames.
    void add(const CacheCounts& later) {
        created += later.created;
        known += later.known;
        served += later.served;
        most = std::max(most, later.most);
        live = later.live;
    }
};

}  // namespace render2mpeg::renderer
