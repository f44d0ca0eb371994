#include "encoder/codec.h"

#include <algorithm>
#include <cmath>

#include "encoder/encoder.h"

namespace render2mpeg::encoder {
namespace {

/// Of AV1's qindex at 8 bits: linear at first, then exponential. [AV1, 7.12.2] to 6 %
double av1_step(double qindex) {
    constexpr double linear_end = 95;
    const double linear = (std::min(qindex, linear_end) + 7) / 8;
    return linear * std::exp2(std::max(0.0, qindex - linear_end) / 38.4);
}

}  // namespace

double step_of(Codec codec, double quantiser) {
    switch (codec) {
        case Codec::h264:
        case Codec::hevc:
            // [H264, table 8-15]: doubles every six, 0.625 at 0.
            return 0.625 * std::exp2(quantiser / 6);
        case Codec::av1:
            return av1_step(4 * quantiser);  // of SVT-AV1's 64 quantisers
        case Codec::mpeg2:
        case Codec::prores:
        case Codec::prores4444:
        case Codec::dnxhr:
        case Codec::ffv1:  // light of masters does not follow their steps
            break;
    }
    return 2 * quantiser;
}

double quantiser_like(Codec codec, double mpeg2_quantiser) {
    if (codec == Codec::mpeg2) return mpeg2_quantiser;
    const CodecFacts& facts = facts_of(codec);
    return std::clamp(facts.at_1 + facts.by_doubling * std::log2(mpeg2_quantiser), static_cast<double>(facts.finest),
                      static_cast<double>(facts.coarsest));
}

double mpeg2_quantiser_like(Codec codec, double quantiser) {
    if (codec == Codec::mpeg2) return quantiser;
    const CodecFacts& facts = facts_of(codec);
    return std::exp2((quantiser - facts.at_1) / facts.by_doubling);
}

std::vector<std::uint8_t> end_of_stream(Codec codec) {
    return codec == Codec::mpeg2 ? sequence_end() : std::vector<std::uint8_t>();
}

}  // namespace render2mpeg::encoder
