#pragma once
// Palettes of pictures, and the colour of one that is nearest.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "encoder/av/rgb_picture.h"

namespace render2mpeg::av {

/// Up to 255 colours that stand for those of a picture: boxes of least variance [Wu1991], then means of what is nearest
/// [Lloyd1982].
class GifPalette {
  public:
    /// Of these code values, at least one.
    explicit GifPalette(std::span<const Rgb> pixels);

    const std::vector<std::array<std::uint8_t, 3>>& colors() const { return codes_; }
    /// Index of the colour with the least weighted squared difference.
    std::size_t nearest(const Rgb& color) const;

  private:
    std::vector<std::array<std::uint8_t, 3>> codes_;  ///< by green
    std::vector<Rgb> colors_;                         ///< the same
};

}  // namespace render2mpeg::av
