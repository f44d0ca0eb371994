#pragma once
// Quantisation and its exact inverse for one quantiser_scale_code.
#include <array>
#include <cstdint>

#include "encoder/mpeg2/bitstream/matrices.h"
#include "encoder/mpeg2/kernels/kernels.h"

/// Quantisation tables for each quantiser_scale_code, scan order and mismatch control.
namespace render2mpeg::encoder::mpeg2 {

/// Tables for one quantiser_scale_code, linear scale.
struct Quantiser {
    QuantTable intra;  ///< entry 0 (DC) quantises to nothing: DC has its own step
    QuantTable non_intra;

    /// With the default matrices; `code` is 1..31.
    static const Quantiser& of(int code);
};

/// The tables of all quantisers with the same matrices.
class QuantiserSet {
  public:
    explicit QuantiserSet(const Matrices& matrices);
    /// `code` is 1..31.
    const Quantiser& of(int code) const;

    /// With the default matrices.
    static const QuantiserSet& standard();

  private:
    std::array<Quantiser, 31> tables_;
};

/// Coefficient in the encoder's order (u * 8 + v) at each place of the scan.
extern const std::array<std::uint8_t, 64> place_of_scan;
/// Place in the scan of each coefficient in raster order.
extern const std::array<std::uint8_t, 64> scan_of_raster;

/// Precision of intra DC in pictures of this quantiser: its step is that of the first AC coefficients, as far as 8 to
/// 10 bits go.
/// chosen: 9 bits at quantiser 2 and 10 at 1 (8 throughout: 0.05 % more bits, and steps in smooth shades of the finest
/// films); 9 bits up to quantiser 4 lose 0.8 %.
constexpr int dc_bits_for(int code) {
    return code == 1 ? 10 : code == 2 ? 9 : 8;
}

/// Mismatch control: makes the sum of all 64 coefficients odd by the last one's lowest bit. [H262, 7.4.4]
void control_mismatch(std::int16_t* coefficients);

}  // namespace render2mpeg::encoder::mpeg2
