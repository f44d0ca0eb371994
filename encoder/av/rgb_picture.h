#pragma once
// Pictures of RGB code values, as GIF has them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/picture.h"

namespace render2mpeg::av {

/// R'G'B' code values, 0..255, not rounded.
using Rgb = std::array<float, 3>;

/// Y'CbCr of the matrix that `matrix_coefficients` names, 6 (BT.601) or else BT.709's: code values, not rounded.
/// [BT709, 3.4], [BT601, 2.5.3]
class RgbMatrix {
  public:
    explicit RgbMatrix(int matrix_coefficients)
        : red_(matrix_coefficients == 6 ? 0.299f : 0.2126f), blue_(matrix_coefficients == 6 ? 0.114f : 0.0722f) {}
    /// That of pictures which do not say it: BT.601's below 720 lines.
    static RgbMatrix usual(int height) { return RgbMatrix(height < 720 ? 6 : 1); }

    Rgb to_ycc(const Rgb& rgb) const {
        const float y = red_ * rgb[0] + (1 - red_ - blue_) * rgb[1] + blue_ * rgb[2];
        return {16 + y * 219 / 255, 128 + (rgb[2] - y) / (1 - blue_) * 112 / 255,
                128 + (rgb[0] - y) / (1 - red_) * 112 / 255};
    }
    /// Clamped to 0..255.
    Rgb to_rgb(const Rgb& ycc) const {
        const float y = (ycc[0] - 16) * 255 / 219, blue = y + (1 - blue_) * (ycc[1] - 128) * 255 / 112,
                    red = y + (1 - red_) * (ycc[2] - 128) * 255 / 112,
                    green = (y - red_ * red - blue_ * blue) / (1 - red_ - blue_);
        const auto limited = [](float value) { return std::clamp(value, 0.0f, 255.0f); };
        return {limited(red), limited(green), limited(blue)};
    }

  private:
    float red_, blue_;  ///< weights in luma
};

/// The 8-bit picture of `rgb_at(x, y)`; chroma on the even columns by [1 2 1] / 4, and the mean of two rows
/// (perceptual/display.cpp).
template <class RgbAt>
core::Picture picture_of_rgb(int width, int height, const RgbMatrix& matrix, const RgbAt& rgb_at) {
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(width, height);
    picture.cb = picture.cr = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2);
    core::Plane<Rgb> ycc(width, height);
    const auto rounded = [](float value) { return static_cast<std::uint8_t>(std::lround(value)); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            ycc.at(x, y) = matrix.to_ycc(rgb_at(x, y));
            picture.y.at(x, y) = rounded(ycc.at(x, y)[0]);
        }
    for (int y = 0; y < picture.cb.height(); ++y)
        for (int x = 0; x < picture.cb.width(); ++x)
            for (const int c : {1, 2}) {
                float sum = 0;
                for (const int row : {2 * y, std::min(2 * y + 1, height - 1)}) {
                    const auto at = [&](int column) {
                        return ycc.at(std::clamp(column, 0, width - 1), row)[static_cast<std::size_t>(c)];
                    };
                    sum += at(2 * x - 1) + 2 * at(2 * x) + at(2 * x + 1);
                }
                (c == 1 ? picture.cb : picture.cr).at(x, y) = rounded(sum / 8);
            }
    return picture;
}

}  // namespace render2mpeg::av
