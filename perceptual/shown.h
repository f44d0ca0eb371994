#pragma once
// Pictures as a screen shows them, in RGB.
#include <cstdint>
#include <vector>

#include "core/picture.h"
#include "perceptual/display.h"

/// What a screen shows of a picture.
namespace render2mpeg::perceptual {

/// What a screen shows of a picture: full-range R'G'B' code values 0..255, 3 per pixel, row by row; chroma interpolated
/// linearly from where MPEG-2 samples it. The inverse of picture_of_signals() but for roundings and for the detail that
/// chroma has lost.
std::vector<std::uint8_t> shown_rgb(const core::Picture& picture, ColorMatrix matrix);

}  // namespace render2mpeg::perceptual
