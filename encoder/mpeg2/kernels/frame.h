#pragma once
// Pictures padded to whole macroblocks.
#include <cstdint>

#include "core/picture.h"
#include "core/plane.h"

/// Pictures padded to whole macroblocks.
namespace render2mpeg::encoder::mpeg2 {

/// A picture of whole macroblocks: luma sides are multiples of 16, chroma half of them.
struct Frame {
    core::Plane<std::uint8_t> y, cb, cr;

    Frame() = default;
    Frame(int columns, int rows) : y(columns * 16, rows * 16), cb(columns * 8, rows * 8), cr(columns * 8, rows * 8) {}
    int columns() const { return y.width() / 16; }  ///< macroblocks
    int rows() const { return y.height() / 16; }

    /// Plane 0 is luma, 1 Cb, 2 Cr.
    core::Plane<std::uint8_t>& plane(int i) { return i == 0 ? y : i == 1 ? cb : cr; }
    const core::Plane<std::uint8_t>& plane(int i) const { return i == 0 ? y : i == 1 ? cb : cr; }
};

/// Fills `frame` with the picture; beyond its right and lower side the last sample repeats.
void pad(const core::Picture& picture, Frame& frame);

/// The upper left width x height luma samples and their chroma.
core::Picture crop(const Frame& frame, int width, int height, std::int64_t number);
/// The same of a frame no longer needed: where nothing is cut off its samples are not copied.
core::Picture crop(Frame&& frame, int width, int height, std::int64_t number);

}  // namespace render2mpeg::encoder::mpeg2
