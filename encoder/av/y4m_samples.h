#pragma once
// Makes pictures of the samples in YUV4MPEG2 files.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/picture.h"
#include "core/rational.h"

namespace render2mpeg::av {

/// Picture format from the header of a Y4M file.
struct Y4mFormat {
    /// Which samples of chroma there are: none, a quarter of luma's, half (in rows), all.
    enum class Chroma { none, c420, c422, c444 };
    /// Where those of 4:2:0 lie. `jpeg`: between four luma samples; `mpeg2`: as in core::Picture; `paldv`: on luma
    /// samples of the even columns, Cr in even rows and Cb in odd ones.
    enum class Siting { jpeg, mpeg2, paldv };

    int width = 0, height = 0;
    std::optional<core::Rational> hertz;         ///< pictures per second; none: the file does not say
    std::optional<core::Rational> pixel_aspect;  ///< width by height of a pixel; none: the file does not say
    Chroma chroma = Chroma::c420;
    Siting siting = Siting::jpeg;
    int depth = 8;            ///< bits of a sample, 8..16; above 8 two bytes, the lower first
    bool full_range = false;  ///< code values 0..255 for black to white
};

/// Bytes of a picture's samples.
std::size_t bytes_of(const Y4mFormat& format);

/// A picture of them. 8-bit 4:2:0 of limited range is handed over bit by bit but for chroma of other sitings than
/// MPEG-2's, which a cubic filter moves by a quarter sample. All else becomes limited range, with luma before rounding
/// and chroma before rounding, at every pixel between samples on straight lines.
core::Picture picture_of(const Y4mFormat& format, std::span<const std::uint8_t> bytes, core::ExactChroma chroma);

}  // namespace render2mpeg::av
