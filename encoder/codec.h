#pragma once
// Differences between codecs: a row each.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Quantisers of B pictures less those of P pictures that nothing refers to, in libavcodec's encoders. `middle`: of the
/// B picture that the others of its run refer to (is_middle).
struct LibraryOffsets {
    int bidirectional = 0, middle = 0;
};

/// All that differs between codecs: one row each.
struct CodecFacts {
    Codec codec;
    std::string_view word;     ///< on the command line: "h264"
    std::string_view name;     ///< "H.264"
    std::string_view scale;    ///< name of its quantisers: "QP"
    std::string_view library;  ///< FFmpeg's encoder: "libx264"
    int finest, coarsest;      ///< quantisers
    int most_b_pictures;       ///< in a row
    /// Its quantisers beside MPEG-2's q: at_1 + by_doubling * log2(q). fit: docs/measurements.md#codecs
    double at_1, by_doubling;
    /// Share of MPEG-2's error that its coding hides: at equal PSNR-Y its steps are larger by more than what they hide.
    /// fit: docs/measurements.md#codecs
    float hidden;
    LibraryOffsets offsets;  ///< chosen: docs/measurements.md#codecs; SVT-AV1 has its own by layers
};

/// In the order of their enumeration.
inline constexpr std::array all_codecs{
    CodecFacts{Codec::mpeg2, "mpeg2", "MPEG-2", "quantiser", "mpeg2video", 1, 31, 3, 0, 1, 1, {}},
    CodecFacts{Codec::h264, "h264", "H.264", "QP", "libx264", 1, 51, 3, 14.9, 5.7, 0.72f, {2, 1}},
    CodecFacts{Codec::hevc, "hevc", "HEVC", "QP", "libx265", 1, 51, 3, 15.6, 5.4, 0.6f, {2, 1}},
    CodecFacts{Codec::av1, "av1", "AV1", "QP", "libsvtav1", 1, 63, 0, 9.4, 11.6, 0.4f, {}}};

constexpr const CodecFacts& facts_of(Codec codec) {
    return all_codecs[static_cast<std::size_t>(codec)];
}

/// Whether B picture `index`, from 0, of a run of `length` is the one in the middle.
constexpr bool is_middle(std::int64_t index, std::int64_t length) {
    return length > 1 && index == length / 2;
}

/// The distance of two levels of a predicted macroblock's coefficient in an orthonormal transform, code values, with
/// the least weight of a matrix.
double step_of(Codec codec, double quantiser);

/// The quantiser of a codec, not rounded, for about the PSNR of MPEG-2's `quantiser`, > 0.
double quantiser_like(Codec codec, double mpeg2_quantiser);
/// The inverse: MPEG-2's equivalent of a codec's quantiser, not rounded; below 1 where MPEG-2 has none as fine.
double mpeg2_quantiser_like(Codec codec, double quantiser);

/// End code after the last picture of a film; empty where a codec has none.
std::vector<std::uint8_t> end_of_stream(Codec codec);

}  // namespace render2mpeg::encoder
