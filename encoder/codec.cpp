#include "encoder/codec.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "encoder/encoder.h"

namespace render2mpeg::encoder {
namespace {

/// A codec's quantisers beside MPEG-2's q: at_1 + by_doubling * log2(q).
struct Likeness {
    double at_1, by_doubling;
};

/// fit: docs/measurements.md#codecs
constexpr std::array<Likeness, 4> likenesses{{{0, 0}, {14.9, 5.7}, {15.6, 5.4}, {9.4, 11.6}}};

Likeness likeness_of(Codec codec) {
    return likenesses[static_cast<std::size_t>(codec)];
}

/// Of AV1's qindex at 8 bits: linear at first, then exponential. [AV1, 7.12.2] to 6 %
double av1_step(double qindex) {
    constexpr double linear_end = 95;
    const double linear = (std::min(qindex, linear_end) + 7) / 8;
    return linear * std::exp2(std::max(0.0, qindex - linear_end) / 38.4);
}

}  // namespace

std::vector<CodecFacts> all_codecs() {
    return {{Codec::mpeg2, "mpeg2", "MPEG-2", "quantiser", 1, 31, 3},
            {Codec::h264, "h264", "H.264", "QP", 1, 51, 3},
            {Codec::hevc, "hevc", "HEVC", "QP", 1, 51, 3},
            {Codec::av1, "av1", "AV1", "QP", 1, 63, 0}};
}

CodecFacts facts_of(Codec codec) {
    return all_codecs()[static_cast<std::size_t>(codec)];
}

double step_of(Codec codec, double quantiser) {
    switch (codec) {
        case Codec::h264:
        case Codec::hevc:
            // [H264, table 8-15]: doubles every six, 0.625 at 0.
            return 0.625 * std::exp2(quantiser / 6);
        case Codec::av1:
            return av1_step(4 * quantiser);  // of SVT-AV1's 64 quantisers
        case Codec::mpeg2:
            break;
    }
    return 2 * quantiser;
}

double quantiser_like(Codec codec, double mpeg2_quantiser) {
    if (codec == Codec::mpeg2) return mpeg2_quantiser;
    const CodecFacts facts = facts_of(codec);
    const Likeness like = likeness_of(codec);
    return std::clamp(like.at_1 + like.by_doubling * std::log2(mpeg2_quantiser), static_cast<double>(facts.finest),
                      static_cast<double>(facts.coarsest));
}

double mpeg2_quantiser_like(Codec codec, double quantiser) {
    if (codec == Codec::mpeg2) return quantiser;
    const Likeness like = likeness_of(codec);
    return std::clamp(std::exp2((quantiser - like.at_1) / like.by_doubling), 1.0, 31.0);
}

std::vector<std::uint8_t> end_of_stream(Codec codec) {
    return codec == Codec::mpeg2 ? sequence_end() : std::vector<std::uint8_t>();
}

}  // namespace render2mpeg::encoder
