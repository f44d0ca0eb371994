#pragma once
// The random numbers of one path.
#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/base/stream.h"

namespace render2mpeg::renderer {

/// Numbers that decide where a path leaves the eye and what it does at its first surface. Paths of one batch cover
/// these dimensions evenly.
enum class FirstNumber : std::uint8_t {
    direction_u,
    direction_v,
    pixel_u,
    pixel_v,
    surface_u,
    surface_v,
    surface,
    lobe,
    lamp,
    lamp_u,
    lamp_v,
    sky,
    sky_u,
    sky_v,
    event,
    fragment,
    count
};
static_assert(static_cast<int>(FirstNumber::count) <= core::halton_dimensions);

/// Uniform numbers of path `index` of a batch, in [0, 1): a function of these alone. The first surface takes a Halton
/// sequence, moved by a shift of the batch's own, so that any mean over paths is without bias; later ones take hashes.
/// [Halton1960], [Cranley1976]
class PathNumbers {
  public:
    /// `batch`: other for every batch of every pixel.
    PathNumbers(const Stream& batch, std::uint64_t index) : batch_(batch), index_(index) {}

    float first(FirstNumber which) const { return batch_.halton(static_cast<int>(which), index_); }
    glm::vec2 first(FirstNumber u, FirstNumber v) const { return {first(u), first(v)}; }

    /// One that nothing had before.
    float next() { return batch_.uniform(index_, ++drawn_); }
    /// A stream that nothing had before.
    Stream next_stream() { return batch_.at(index_).at(++drawn_); }

  private:
    Stream batch_;
    std::uint64_t index_, drawn_ = 0;
};

}  // namespace render2mpeg::renderer
