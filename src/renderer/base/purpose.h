#pragma once
// Seeds of random numbers, by their purpose.
#include <cstdint>

#include "core/sampling.h"

namespace render2mpeg::renderer {

/// Purposes of random numbers. Each has streams of its own, so that no two are correlated.
enum class Purpose : std::uint64_t {
    sides_of_faces = 1,
    open_directions,
    audited_pixels,
    spread_audits,
    audited_rays,
    lobe_rays,
    guided_rays,
    strands,
};

/// Seed of stream `stream` of a purpose.
inline std::uint64_t seed_of(Purpose purpose, std::uint64_t stream = 0) {
    return core::mix(core::mix(static_cast<std::uint64_t>(purpose)) ^ stream);
}

}  // namespace render2mpeg::renderer
