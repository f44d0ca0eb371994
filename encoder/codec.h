#pragma once
// Differences between codecs in the planning and reporting of films.
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "encoder/types.h"

namespace render2mpeg::encoder {

/// A codec's names and the scale of its quantisers.
struct CodecFacts {
    Codec codec;
    std::string_view word;   ///< on the command line: "h264"
    std::string_view name;   ///< "H.264"
    std::string_view scale;  ///< name of its quantisers: "QP"
    int finest, coarsest;    ///< quantisers
    int most_b_pictures;     ///< in a row
};

/// All codecs, in the order of their enumeration.
std::vector<CodecFacts> all_codecs();
CodecFacts facts_of(Codec codec);

/// The distance of two levels of a predicted macroblock's coefficient in an orthonormal transform, code values, with
/// the least weight of a matrix.
double step_of(Codec codec, double quantiser);

/// The quantiser of a codec, not rounded, for about the PSNR of MPEG-2's `quantiser`, > 0.
double quantiser_like(Codec codec, double mpeg2_quantiser);
/// The inverse: MPEG-2's equivalent of a codec's quantiser, not rounded.
double mpeg2_quantiser_like(Codec codec, double quantiser);

/// End code after the last picture of a film; empty where a codec has none.
std::vector<std::uint8_t> end_of_stream(Codec codec);

}  // namespace render2mpeg::encoder
