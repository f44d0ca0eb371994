#pragma once
// Blocks of a GIF file [GIF89a].
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace render2mpeg::av {

using GifBytes = std::vector<std::uint8_t>;

/// Beginning of a film that is shown again and again: header, screen, Netscape's extension. [GIF89a, 17, 18]
GifBytes gif_header(int width, int height);

/// A picture, or the part of one that changes.
struct GifImage {
    int x = 0, y = 0, width = 1, height = 1;              ///< on the screen
    int hundredths = 4;                                   ///< of a second that it is shown
    bool is_cleared = false;                              ///< afterwards nothing is left in its place
    std::span<const std::array<std::uint8_t, 3>> colors;  ///< 255 at most; the index behind them is transparent
    std::vector<std::uint8_t> indices;                    ///< width by height, row by row
};

/// With its own palette. [GIF89a, 20 to 23]
GifBytes gif_image(const GifImage& image);

/// End of a film. [GIF89a, 27]
inline constexpr std::uint8_t gif_trailer = 0x3b;

}  // namespace render2mpeg::av
