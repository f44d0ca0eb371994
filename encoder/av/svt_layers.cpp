#include "encoder/av/svt_layers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

/// Key pictures, the last picture of a group, its middle, middles of halves, of quarters, pictures between, and a layer
/// that groups of 32 would have. chosen: docs/measurements.md#codecs
constexpr std::array by_layer{0.38f, 0.48f, 0.75f, 0.84f, 0.92f, 1.0f, 1.0f};

/// `place` 1..`size` in a group of 2^`layers`.
float in_group(std::uint64_t place, int layers) {
    return by_layer[static_cast<std::size_t>(1 + layers - std::countr_zero(place))];
}

/// Of a layer at a quantiser; 0 would be lossless.
int index_of(std::size_t layer, double quantiser) {
    const double step = by_layer[layer] * encoder::step_of(encoder::Codec::av1, quantiser);
    return std::max(1, static_cast<int>(std::lround(encoder::av1_index_of(step))));
}

}  // namespace

float svt_step_ratio(std::int64_t place, std::int64_t last) {
    if (place <= 0) return by_layer[0];
    std::int64_t before = 0;
    for (int layers = 4; layers >= 2; --layers) {
        const std::int64_t size = std::int64_t{1} << layers;
        for (; last - before >= size; before += size)
            if (place <= before + size) return in_group(static_cast<std::uint64_t>(place - before), layers);
    }
    // The rest as the beginning of a group of four.
    return in_group(static_cast<std::uint64_t>(place - before), 2);
}

int svt_quantiser(double quantiser) {
    constexpr int largest_offset = 64;
    const int reaches = static_cast<int>((index_of(0, quantiser) + largest_offset) / indices_of_quantiser);
    return std::min(static_cast<int>(std::lround(quantiser)), reaches);
}

IndexOffsets svt_index_offsets(double quantiser) {
    const int whole = static_cast<int>(indices_of_quantiser) * svt_quantiser(quantiser);
    IndexOffsets offsets{};
    for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = index_of(i, quantiser) - whole;
    return offsets;
}

}  // namespace render2mpeg::av
