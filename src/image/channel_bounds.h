#pragma once
// Least and largest values of one channel of a texture, over boxes of texture coordinates.
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/plane.h"
#include "image/texture.h"

namespace render2mpeg::image {

/// The values between which something lies.
struct Bounds {
    float low = 0, high = 0;

    bool operator==(const Bounds&) const = default;
};

/// A pyramid of the least and the largest texel of a channel (Texture::texel).
class ChannelBounds {
  public:
    ChannelBounds(const Texture& texture, int channel);

    /// Of all samples without a footprint within a box, whose coordinates may be off by a hundredth of a texel; they
    /// lie between these texels but for their own rounding. Nothing where the box is not finite or lies too far off
    /// for coordinates to have fractions.
    std::optional<Bounds> within(glm::dvec2 low, glm::dvec2 high) const;

    /// Of all texels.
    Bounds all() const { return levels_.back().at(0, 0); }

  private:
    struct Texels {
        int first, last;
    };
    Bounds over(Texels columns, Texels rows) const;

    glm::ivec2 size_;
    core::Wrap wrap_u_, wrap_v_;
    int block_ = 1;                            ///< texels along a side of the finest cells
    std::vector<core::Plane<Bounds>> levels_;  ///< each half as wide and high as the one before, rounded up
};

}  // namespace render2mpeg::image
