#pragma once

#include <cstdint>

#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"

/// Prediction of macroblocks from reconstructed references, and what it leaves. Vectors keep inside the reference
/// (vector_range).
namespace render2mpeg::encoder::mpeg2 {

/// Luma and chroma prediction of a macroblock: 16x16 samples, then 8x8 of Cb and Cr.
struct Prediction {
    alignas(32) std::uint8_t y[256];
    alignas(32) std::uint8_t cb[64];
    alignas(32) std::uint8_t cr[64];
};

/// [H262, 7.6.3.7 and 7.6.4]
void predict_luma(const Frame& reference, int column, int row, Vector v, std::uint8_t* out);  ///< 16x16 samples
void predict_chroma(const Frame& reference, int column, int row, Vector v, Prediction& out);

/// Hadamard sum (Kernels::satd_16x16) of a macroblock's luma less its prediction.
std::uint32_t satd(const Frame& picture, const Frame& reference, int column, int row, Vector v);
/// The same for the mean of two predictions, whose 16x16 samples `mean` gets.
std::uint32_t satd_of_mean(const Frame& picture, const Frame& earlier, const Frame& later, int column, int row,
                           const Vector (&vectors)[2], std::uint8_t* mean);

}  // namespace render2mpeg::encoder::mpeg2
