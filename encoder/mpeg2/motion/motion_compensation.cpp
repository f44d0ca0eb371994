#include "encoder/mpeg2/motion/motion_compensation.h"

#include "encoder/mpeg2/kernels/kernels.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Where a vector leads from a macroblock's upper left sample of luma, but for half pixels.
const std::uint8_t* luma_at(const Frame& reference, int column, int row, Vector v) {
    return reference.y.row(row * 16 + (v.y >> 1)) + column * 16 + (v.x >> 1);
}

/// Kernels' `half` for the half pixels of a vector.
int half_of(int x, int y) {
    return (x & 1) | (y & 1) << 1;
}

}  // namespace

void predict_luma(const Frame& reference, int column, int row, Vector v, std::uint8_t* out) {
    kernels().predict_16x16(out, 16, luma_at(reference, column, row, v), reference.y.width(), half_of(v.x, v.y));
}

void predict_chroma(const Frame& reference, int column, int row, Vector v, Prediction& out) {
    const Kernels& k = kernels();
    // Halve the vector towards zero for chroma. [H262, 7.6.3.7]
    const int x = v.x / 2, y = v.y / 2, half = half_of(x, y);
    const auto stride = static_cast<std::ptrdiff_t>(reference.cb.width());
    for (int plane = 1; plane <= 2; ++plane) {
        const std::uint8_t* chroma = reference.plane(plane).row(row * 8 + (y >> 1)) + column * 8 + (x >> 1);
        k.predict_8x8(plane == 1 ? out.cb : out.cr, 8, chroma, stride, half);
    }
}

std::uint32_t satd(const Frame& picture, const Frame& reference, int column, int row, Vector v) {
    const Kernels& k = kernels();
    const auto stride = static_cast<std::ptrdiff_t>(picture.y.width());
    const std::uint8_t* here = picture.y.row(row * 16) + column * 16;
    const std::uint8_t* there = luma_at(reference, column, row, v);
    const int half = half_of(v.x, v.y);
    if (half == 0) return k.satd_16x16(here, stride, there, stride);
    alignas(32) std::uint8_t prediction[256];
    k.predict_16x16(prediction, 16, there, stride, half);
    return k.satd_16x16(here, stride, prediction, 16);
}

std::uint32_t satd_of_mean(const Frame& picture, const Frame& earlier, const Frame& later, int column, int row,
                           const Vector (&vectors)[2], std::uint8_t* mean) {
    alignas(32) std::uint8_t second[256];
    predict_luma(earlier, column, row, vectors[0], mean);
    predict_luma(later, column, row, vectors[1], second);
    kernels().average(mean, second, 256);
    return kernels().satd_16x16(picture.y.row(row * 16) + column * 16, picture.y.width(), mean, 16);
}

}  // namespace render2mpeg::encoder::mpeg2
