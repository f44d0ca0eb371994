#pragma once
// Codes one 8x8 block: transform, quantisation, RDOQ, reconstruction, bits.
#include <cstdint>
#include <vector>

#include "encoder/mpeg2/bitstream/codes.h"
#include "encoder/mpeg2/kernels/kernels.h"

/// Codes one 8x8 block: quantisation, RDOQ, lengths of its codes, writing.
namespace render2mpeg::encoder::mpeg2 {

/// A block's coefficients as they wait to be written: `run` zeros in scan order, then a level.
struct RunLevel {
    std::uint8_t run;
    std::int16_t level;
};

/// Lengths of coefficient codes, sign included, escapes resolved.
class CoefficientLengths {
  public:
    explicit CoefficientLengths(const CoefficientCodes& codes);
    CoefficientLengths(const CoefficientLengths&) = delete;
    CoefficientLengths& operator=(const CoefficientLengths&) = delete;

    int bits(int run, int magnitude) const { return magnitude < levels ? length_[run][magnitude] : escape_bits; }
    /// Of the coefficient at `scan`, after the one at `before` (-1: none before).
    int bits_after(int before, int scan, int magnitude, bool intra) const {
        // The first coefficient of a non-intra block has a shorter code for level 1 at once. [H262, 7.2.2.1]
        if (!intra && scan == 0 && magnitude == 1) return 2;
        return bits(scan - before - 1, magnitude);
    }
    int end_of_block() const { return end_of_block_; }

    static const CoefficientLengths& zero();  ///< table B-14
    static const CoefficientLengths& one();   ///< table B-15

  private:
    static constexpr int levels = 64;
    std::uint8_t length_[64][levels];  ///< [run][magnitude 1..]
    int end_of_block_;
};

/// Weights of the squares of coefficients' errors, in the encoder's order.
struct Weights {
    alignas(32) float of[64];
};

/// One 8x8 block through DCT and quantisation; arrays in the encoder's order (kernels.h).
struct Block {
    alignas(32) float coefficients[64];
    alignas(32) std::int16_t levels[64];
    alignas(32) std::int16_t dequantised[64];
    const Weights* weights = nullptr;  ///< of distortion and energy; null: all 1
    std::uint64_t scan_mask;           ///< bit i: the i-th coefficient of the scan is not 0 (intra: DC never counts)
    float distortion;                  ///< squared error as coded, weighted
    float energy;                      ///< of a non-intra block that is not coded
    int bits;                          ///< of a coded block: coefficients and end, with table B-14
    int dc;                            ///< intra: quantised DC, 0..2^precision - 1
};

/// Quantises `block.coefficients`, all of them. The block then holds everything but `bits` and `dc`.
void quantise_non_intra(Block& block, const QuantTable& table);
/// Likewise; DC by its own step of 8, 4 or 2 with 8, 9 or 10 bits of precision.
void quantise_intra(Block& block, const QuantTable& table, int dc_bits);

/// Bits of the coefficients and the end of the block; of the AC coefficients only for an intra block.
int coefficient_bits(const Block& block, const CoefficientLengths& lengths, bool intra);

/// Distortion from an error of the coefficient at `place`.
inline float loss_of(const Block& block, std::size_t place, float error) {
    return block.weights ? block.weights->of[place] * error * error : error * error;
}

/// Bits of an intra DC difference.
int dc_bits(int difference, bool luma);

/// Appends the coefficients in scan order; an intra block without its DC.
void append_runs(const Block& block, std::vector<RunLevel>& runs, bool intra);

void write_dc(BitWriter& out, int difference, bool luma);
/// `count` runs and the end of the block.
void write_coefficients(BitWriter& out, const RunLevel* runs, int count, const CoefficientCodes& codes, bool intra);

}  // namespace render2mpeg::encoder::mpeg2
