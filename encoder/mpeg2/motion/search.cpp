#include "encoder/mpeg2/motion/search.h"

#include <cstdint>

#include "encoder/mpeg2/kernels/kernels.h"

namespace render2mpeg::encoder::mpeg2 {

namespace {

/// Sum of absolute differences of the macroblock and the reference at a whole-pixel vector.
std::uint32_t difference(const Frame& picture, const Frame& reference, int column, int row, Vector v) {
    const Kernels& k = kernels();
    const auto stride = static_cast<std::ptrdiff_t>(picture.y.width());
    const std::uint8_t* here = picture.y.row(row * 16) + column * 16;
    const std::uint8_t* there = reference.y.row(row * 16 + (v.y >> 1)) + column * 16 + (v.x >> 1);
    return k.sad_8x8(here, stride, there, stride) + k.sad_8x8(here + 8, stride, there + 8, stride) +
           k.sad_8x8(here + 8 * stride, stride, there + 8 * stride, stride) +
           k.sad_8x8(here + 8 * stride + 8, stride, there + 8 * stride + 8, stride);
}

}  // namespace

SearchResult search(const Frame& picture, const Frame& reference, int column, int row, const VectorRange& allowed,
                    Vector centre, float cost_per_bit, int range) {
    const ComponentBits price(f_code_for(-2 * range, 2 * range));
    SearchResult result;
    float costs[SearchResult::most] = {};
    for (int y = -range; y <= range; ++y)
        for (int x = -range; x <= range; ++x) {
            const Vector v{static_cast<std::int16_t>((centre.x & ~1) + 2 * x),
                           static_cast<std::int16_t>((centre.y & ~1) + 2 * y)};
            if (!allowed.contains(v)) continue;
            ++result.evaluations;
            const float cost = static_cast<float>(difference(picture, reference, column, row, v)) +
                               cost_per_bit * static_cast<float>(price(2 * x) + price(2 * y));

            // Keep it among the best, in order.
            int place = result.count;
            while (place > 0 && cost < costs[place - 1]) --place;
            if (place == SearchResult::most) continue;
            if (result.count < SearchResult::most) ++result.count;
            for (int i = result.count - 1; i > place; --i) {
                costs[i] = costs[i - 1];
                result.vector[i] = result.vector[i - 1];
            }
            costs[place] = cost;
            result.vector[place] = v;
        }
    return result;
}

}  // namespace render2mpeg::encoder::mpeg2
