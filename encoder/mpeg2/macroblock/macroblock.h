#pragma once
// Codes one macroblock in one mode, with its distortion and bits.
#include <cstdint>
#include <optional>

#include "encoder/mpeg2/bitstream/codes.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/block_coding.h"
#include "encoder/mpeg2/motion/fast_motion_search.h"
#include "encoder/mpeg2/motion/motion_compensation.h"

/// Tries a macroblock in one mode, counts its bits and distortion, and reconstructs it.
namespace render2mpeg::encoder::mpeg2 {

/// Predictors within a slice at a macroblock. Reset at the slice's start. [H262, 7.2.1 and 7.6.3.4]
struct SliceState {
    int dc_reset = 128;  ///< half the range of the picture's intra DC precision
    int dc[3] = {dc_reset, dc_reset, dc_reset};
    /// Of the macroblock before; its vectors predict the next ones. [H262, 7.6.3]
    PredictionMode mode{{}, {false, false}};
    int quantiser = 1;  ///< in force
    int skipped = 0;    ///< macroblocks since the last coded one

    SliceState() = default;
    /// At the start of a slice.
    SliceState(int dc_bits, int slice_quantiser) : dc_reset(1 << (dc_bits - 1)), quantiser(slice_quantiser) {}

    void reset_dc() { dc[0] = dc[1] = dc[2] = dc_reset; }
};

/// Coding state that is constant within a picture.
struct PictureCoding {
    const Frame& source;
    const Frame* reference[2];  ///< earlier, later; null: none
    Frame& reconstruction;
    PictureType type;
    int f_code[2][2];     ///< [direction][axis]
    float lambda_factor;  ///< lambda = lambda_factor * q^2
    Effort effort = Effort::quality;
    const QuantiserSet* quantisers = &QuantiserSet::standard();
    int dc_bits = 8;                                       ///< precision of intra DC, 8..10
    const Weights* weights = nullptr;                      ///< of errors of luma; null: all 1
    const core::Plane<std::uint8_t>* intra_due = nullptr;  ///< 1: intra or skipped; null: none
    const core::Plane<Force>* forced = nullptr;            ///< null: nothing
    const FastMotionSearch* fast_search = nullptr;         ///< null: vectors are chosen beforehand
    const VectorBits* bits[2] = {};                        ///< by `f_code`; null: no costs to go are known
};

/// How one macroblock is coded, ready to be written.
struct MacroblockCode {
    MacroblockType type;
    bool skipped = false;
    std::uint8_t pattern = 0;    ///< coded_block_pattern; 63 for intra
    std::uint8_t quantiser = 1;  ///< in force
    PredictionMode mode;         ///< of a macroblock that is not intra
    std::uint16_t dc[6] = {};    ///< intra: quantised DCs
    std::uint8_t runs[6] = {};   ///< coefficients per block in the row's list
    std::uint32_t bits = 0;      ///< once written; includes the cost of macroblocks skipped before it
};

/// Rate and distortion of a trial.
struct RdCost {
    MacroblockType type;
    int pattern = 0;        ///< coded_block_pattern; 63 for intra
    float distortion = 0;   ///< squared error of luma, weighted, and chroma
    int bits = 0;           ///< whole macroblock but for the address increment; intra blocks with table B-14
    int bits_with_one = 0;  ///< the same with table B-15 for intra blocks

    float cost(float lambda) const { return distortion + lambda * static_cast<float>(bits); }
};

/// A macroblock tried in one way: everything needed to compare and to keep it.
struct ModeTrial {
    Block block[6];  ///< Y upper left, upper right, lower left, lower right, Cb, Cr
    Prediction prediction;
    PredictionMode mode;
    int quantiser = 1;
    RdCost rd;
};

/// The Lagrangian: squared error per bit.
inline float lambda_of(const PictureCoding& picture, int quantiser) {
    return picture.lambda_factor * static_cast<float>(quantiser * quantiser);
}

/// Tries the macroblock predicted by `mode`; blocks not worth their bits are dropped. `out` may hold the prediction
/// of luma already.
void try_inter(const PictureCoding& picture, int column, int row, const PredictionMode& mode, int quantiser,
               const SliceState& state, ModeTrial& out, bool luma_is_predicted = false);

/// Tries it intra.
void try_intra(const PictureCoding& picture, int column, int row, int quantiser, const SliceState& state,
               ModeTrial& out);

/// Prediction of a macroblock by a mode that uses at least one direction. The mean of two rounds up.
/// [H262, 7.6.7.1]
void predict_luma(const PictureCoding& picture, int column, int row, const PredictionMode& mode, Prediction& out);
void predict_chroma(const PictureCoding& picture, int column, int row, const PredictionMode& mode, Prediction& out);

/// Prediction of a macroblock skipped here: by zero in a P picture, like the one before in a B picture.
/// [H262, 7.6.6] Null where it must not be skipped: after an intra macroblock, or where the vectors would lead out of
/// the picture. Holds until the state changes.
const PredictionMode* skip_mode(const PictureCoding& picture, int column, int row, const SliceState& state);

/// Bits of the vectors that a mode uses.
int vector_bits(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode);

/// Bits of the macroblocks behind, by the vectors that `mode` leaves as their predictors (advance()). `to_go`: of each
/// direction, null where it has no reference.
float cost_to_go(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode,
                 const CostToGo* const (&to_go)[2]);

/// Squared error of the macroblock as its prediction, weighted like any other.
float luma_distortion(const PictureCoding& picture, int column, int row, const Prediction& prediction);
float chroma_distortion(const PictureCoding& picture, int column, int row, const Prediction& prediction);

/// Makes blocks empty from the high frequencies down until the macroblock has at most `limit` bits.
void truncate_to(ModeTrial& trial, const PictureCoding& picture, const SliceState& state, int limit);

/// Writes the decoded macroblock into the picture's reconstruction.
void reconstruct(const PictureCoding& picture, int column, int row, ModeTrial& trial);
void reconstruct_skipped(const PictureCoding& picture, int column, int row, const Prediction& prediction);

/// The state after a macroblock that was coded so.
void advance(SliceState& state, const MacroblockCode& code);

/// Bits of macroblock_address_increment for an increment of 1 + skipped.
int address_increment_bits(int skipped);

}  // namespace render2mpeg::encoder::mpeg2
