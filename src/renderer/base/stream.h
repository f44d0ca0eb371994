#pragma once
// Random numbers: where they come from, and what they decide.
#include <cstdint>
#include <glm/glm.hpp>

#include "core/sampling.h"

namespace render2mpeg::renderer {

/// Purposes of random numbers. Each has streams of its own, so that no two are correlated.
enum class Purpose : std::uint64_t {
    audited_pixels = 3,
    spread_audits,
    audited_rays,
    guided_rays = 7,
    strands,
    hemisphere_rays,
    rays_of_fog,
    rays_of_view,
    places_of_cells,
    paths_of_cells,
    near_points,
    lamp_points,
    representatives,
    photons = 18,
    true_paths,
    rays_of_volumes,
    shared_points,
};

/// Whose numbers a stream has. What is alike for all pixels, or in all frames, names none.
struct StreamKey {
    glm::ivec2 pixel{0};
    std::int64_t frame = 0;
    std::uint64_t index = 0;
};

/// A stream of random numbers: a function of its purpose and its key, whatever was drawn before.
class Stream {
  public:
    Stream() = default;
    explicit Stream(Purpose purpose, const StreamKey& key = {})
        : Stream(Stream()
                     .with(purpose)
                     .at(std::uint64_t{static_cast<std::uint32_t>(key.pixel.y)} << 32 |
                         static_cast<std::uint32_t>(key.pixel.x))
                     .at(static_cast<std::uint64_t>(key.frame))
                     .at(key.index)) {}

    /// The stream of one of its parts.
    Stream at(std::uint64_t part) const { return Stream(core::mix(bits_ ^ part)); }
    /// That of the same thing for something else.
    Stream with(Purpose purpose) const { return at(core::mix(static_cast<std::uint64_t>(purpose))); }

    /// A number in [0, 1), 24 bits, by up to two counters.
    float uniform(std::uint64_t a, std::uint64_t b = 0) const {
        return static_cast<float>(at(a).at(b).bits_ >> 40) * 0x1p-24f;
    }
    /// Element `index` of a dimension of the Halton sequence [Halton1960], moved by a shift of the stream's own, so
    /// that means over any number of elements have no bias [Cranley1976].
    float halton(int dimension, std::uint64_t index) const;
    /// Element `index` of Sobol's first two dimensions [Sobol1967], scrambled by the stream [Laine2011]: any power of
    /// two of them in a row lie evenly.
    glm::vec2 sobol(std::uint32_t index) const;
    /// 64 bits that look random.
    std::uint64_t bits() const { return bits_; }

    bool operator==(const Stream&) const = default;

  private:
    explicit Stream(std::uint64_t bits) : bits_(bits) {}

    std::uint64_t bits_ = 0;
};

}  // namespace render2mpeg::renderer
