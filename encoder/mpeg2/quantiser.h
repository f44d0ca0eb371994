#pragma once

#include <array>
#include <cstdint>

#include "encoder/mpeg2/kernels.h"

namespace render2mpeg::encoder::mpeg2 {

/// Tables for one quantiser_scale_code: default intra matrix and flat non-intra matrix [H262, 6.3.11], linear scale.
struct Quantiser {
    QuantTable intra;  ///< entry 0 (DC) quantises to nothing: DC has its own step
    QuantTable non_intra;

    /// `code` is 1..31.
    static const Quantiser& of(int code);
};

/// The default intra matrix, raster order.
extern const std::array<std::uint8_t, 64> default_intra_matrix;

/// Coefficient in the encoder's order (u * 8 + v) at each place of the scan.
extern const std::array<std::uint8_t, 64> place_of_scan;
/// Place in the scan of each coefficient in raster order.
extern const std::array<std::uint8_t, 64> scan_of_raster;

/// Mismatch control: makes the sum of all 64 coefficients odd by the last one's lowest bit. [H262, 7.4.4]
void control_mismatch(std::int16_t* coefficients);

}  // namespace render2mpeg::encoder::mpeg2
