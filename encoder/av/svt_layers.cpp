#include "encoder/av/svt_layers.h"

#include <bit>

namespace render2mpeg::av {
namespace {

constexpr float key_picture = 0.28f;
/// The last picture of a group, its middle, middles of halves, of quarters; and pictures between that others refer to.
constexpr float by_layer[] = {0.42f, 0.7f, 0.84f, 0.92f, 0.97f};

/// `place` 1..`size` in a group of 2^`layers`.
float in_group(std::uint64_t place, int layers, bool refers_to_first) {
    const int layer = layers - std::countr_zero(place);
    const bool is_between = layer == layers;
    const bool is_referred_to = refers_to_first && place % 8 == 1;
    return is_between && !is_referred_to ? 1.0f : by_layer[layer];
}

}  // namespace

float svt_step_ratio(std::int64_t place, std::int64_t last, encoder::Effort effort) {
    if (place <= 0) return key_picture;
    const bool slow = effort == encoder::Effort::quality;
    std::int64_t before = 0;
    for (int layers = 4; layers >= 2; --layers) {
        const std::int64_t size = std::int64_t{1} << layers;
        for (; last - before >= size; before += size)
            if (place <= before + size) return in_group(static_cast<std::uint64_t>(place - before), layers, slow);
    }
    // The rest as the beginning of a group of four.
    return in_group(static_cast<std::uint64_t>(place - before), 2, slow);
}

}  // namespace render2mpeg::av
