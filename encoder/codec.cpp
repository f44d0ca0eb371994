#include "encoder/codec.h"

#include <algorithm>
#include <cmath>

#include "encoder/encoder.h"

namespace render2mpeg::encoder {
namespace {

/// Steps of AV1 and VP9 by base_q_idx at 8 bits: linear up to this, then exponential. [AV1, 7.12.2] to 6 %
constexpr double linear_end = 95, doubling = 38.4;

double av1_step(double index) {
    const double linear = (std::min(index, linear_end) + 7) / 8;
    return linear * std::exp2(std::max(0.0, index - linear_end) / doubling);
}

}  // namespace

double av1_index_of(double step) {
    const double end = av1_step(linear_end);
    return step <= end ? 8 * step - 7 : linear_end + doubling * std::log2(step / end);
}

double step_of(Codec codec, double quantiser) {
    switch (codec) {
        case Codec::h264:
        case Codec::hevc:
            // [H264, table 8-15]: doubles every six, 0.625 at 0.
            return 0.625 * std::exp2(quantiser / 6);
        case Codec::av1:
        case Codec::vp9:                     // [VP9, 8.6.1]: the same tables
            return av1_step(4 * quantiser);  // of 64 quantisers of SVT-AV1 and libvpx
        case Codec::mpeg2:
        case Codec::prores:
        case Codec::prores_422:
        case Codec::prores_lt:
        case Codec::prores_proxy:
        case Codec::prores4444:
        case Codec::prores4444xq:
        case Codec::dnxhr:
        case Codec::ffv1:
        case Codec::h264_lossless:
        case Codec::gif:  // light of masters does not follow their steps
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
