#pragma once
// The inner loops of coding (transform, quantisation, differences, prediction), by instruction set.
#include <cstddef>
#include <cstdint>

/// The loops over samples and coefficients, chosen for the processor at run time.
namespace render2mpeg::encoder::mpeg2 {

/// Coefficients lie by columns inside the encoder, [u * 8 + v] with u the horizontal frequency: then each transform
/// transposes once. Scale: the orthonormal 8x8 DCT, which is also the stream's.

/// How 64 coefficients are quantised: level = trunc(|c| * reciprocal + rounding), at most `highest`, and back to
/// ((2 level + reconstruction) * weight) / 16 truncated, with the sign of c. [H262, 7.4.2.3]
struct QuantTable {
    alignas(32) float reciprocal[64];      ///< 1 / step; 0: always level 0
    alignas(32) std::int32_t weight[64];   ///< matrix entry times quantiser_scale_code (half of quantiser_scale)
    alignas(32) std::int32_t highest[64];  ///< largest level: escape codes end at 2047, and no coefficient may saturate
    float largest_reciprocal;              ///< of all
    float rounding;                        ///< 0.5: nearest
    std::int32_t reconstruction;           ///< 0 intra, 1 non-intra
};

/// Magnitude of the coefficient that a level of this magnitude stands for.
inline int dequantised_magnitude(const QuantTable& table, int place, int magnitude) {
    return magnitude == 0 ? 0 : ((2 * magnitude + table.reconstruction) * table.weight[place]) >> 4;
}

struct Quantised {
    std::uint64_t nonzero;  ///< bit [v * 8 + u] (raster order) set where the level is not 0
    float distortion;       ///< sum over (coefficient - dequantised)^2
    float energy;           ///< sum over coefficient^2: the distortion of the block not coded
};

/// The pixel and coefficient loops, in one variant per instruction set; all give the same numbers, bit for bit.
/// Strides are in bytes. `half` is 1 for half a pixel to the right, 2 for half a pixel down, 3 for both.
struct Kernels {
    /// Sum of absolute 8x8 Hadamard coefficients (gain 8 over orthonormal) of a 16x16 difference.
    std::uint32_t (*satd_16x16)(const std::uint8_t* a, std::ptrdiff_t a_stride, const std::uint8_t* b,
                                std::ptrdiff_t b_stride);
    /// The same of the block by itself, without the four DCs: an estimate for intra coding.
    std::uint32_t (*activity_16x16)(const std::uint8_t* a, std::ptrdiff_t a_stride);
    std::uint32_t (*ssd_16x16)(const std::uint8_t* a, std::ptrdiff_t a_stride, const std::uint8_t* b,
                               std::ptrdiff_t b_stride);
    std::uint32_t (*ssd_8x8)(const std::uint8_t* a, std::ptrdiff_t a_stride, const std::uint8_t* b,
                             std::ptrdiff_t b_stride);
    /// Sum of absolute differences.
    std::uint32_t (*sad_16x16)(const std::uint8_t* a, std::ptrdiff_t a_stride, const std::uint8_t* b,
                               std::ptrdiff_t b_stride);

    /// Half-pel prediction. [H262, 7.6.4] Reads one column and row more where `half` asks for it.
    void (*predict_16x16)(std::uint8_t* out, std::ptrdiff_t out_stride, const std::uint8_t* reference,
                          std::ptrdiff_t stride, int half);
    void (*predict_8x8)(std::uint8_t* out, std::ptrdiff_t out_stride, const std::uint8_t* reference,
                        std::ptrdiff_t stride, int half);

    /// a = (a + b + 1) / 2 for `count` samples, a multiple of 32.
    void (*average)(std::uint8_t* a, const std::uint8_t* b, int count);

    /// DCT of samples, or of samples minus prediction.
    void (*forward_dct)(float* coefficients, const std::uint8_t* samples, std::ptrdiff_t stride);
    void (*forward_dct_of_difference)(float* coefficients, const std::uint8_t* samples, std::ptrdiff_t stride,
                                      const std::uint8_t* prediction, std::ptrdiff_t prediction_stride);
    /// `levels` and `dequantised` get 64 values each.
    Quantised (*quantise)(const float* coefficients, const QuantTable& table, std::int16_t* levels,
                          std::int16_t* dequantised);

    /// The result of `quantise` apart from `nonzero`, with the square of each coefficient's error weighted.
    Quantised (*weigh)(const float* coefficients, const std::int16_t* dequantised, const float* weights);

    /// The inverse DCT of libavcodec's `simple` decoder, clipped into `out`, or added to its contents.
    void (*inverse_dct_put)(const std::int16_t* coefficients, std::uint8_t* out, std::ptrdiff_t stride);
    void (*inverse_dct_add)(const std::int16_t* coefficients, std::uint8_t* out, std::ptrdiff_t stride);
};

namespace detail {
/// From before main() on the best variant; while statics are made it may still be the first one.
extern const Kernels* kernels_in_use;
}  // namespace detail

/// The variant for this processor.
inline const Kernels& kernels() {
    return *detail::kernels_in_use;
}

/// All variants that this processor can run, for tests; the first one needs nothing beyond the build's own target.
struct KernelVariants {
    const Kernels* variant[3];
    int count;
};
KernelVariants kernel_variants();

}  // namespace render2mpeg::encoder::mpeg2
