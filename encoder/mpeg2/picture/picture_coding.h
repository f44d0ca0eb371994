#pragma once
// Codes one picture: all its rows, then tables, f_codes and bits.
#include <cstdint>
#include <vector>

#include "encoder/cadence.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/block_coding.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "encoder/types.h"

/// Codes one picture: vectors, decisions, header and slices.
namespace render2mpeg::encoder::mpeg2 {

/// Inputs for coding a picture.
struct PictureTask {
    const Frame& source;
    PictureType type;
    const Frame* reference[2];                 ///< earlier and later; null where the type has none
    const core::Plane<Candidates>* exact[2];   ///< the renderer's vectors to each; null: none known
    const core::Plane<Vector>* predictors[2];  ///< vectors to each that another picture suggests; null: none
    int lines;                                 ///< of the picture as displayed
    int temporal_reference;
    int quantiser;
    Effort effort;
    ShownFields shown;
    const QuantiserSet* quantisers = &QuantiserSet::standard();
    const Weights* weights = nullptr;                      ///< of errors of luma; null: all 1
    const core::Plane<std::uint8_t>* intra_due = nullptr;  ///< 1: intra or skipped; null: none
    /// Factor on `quantiser` in each macroblock; null: 1.
    const core::Plane<float>* quantiser_factors = nullptr;
    const core::Plane<Force>* forced = nullptr;  ///< null: nothing
    float bit_weight = 1;                        ///< how much dearer bits are than tuning.h makes them
};

struct PictureResult {
    std::vector<std::uint8_t> bytes;  ///< picture header and slices
    Frame reconstruction;
    core::Plane<MacroblockRecord> records;
    core::Plane<Vector> vectors;    ///< of a P picture: those of inter macroblocks, zero elsewhere; empty for others
    std::uint64_t evaluations = 0;  ///< 16x16 Hadamard differences computed
    MotionWork motion;
};

/// Codes one picture, rows in parallel; the bytes do not depend on the number of threads.
PictureResult code_picture(const PictureTask& task, const Level& level);

}  // namespace render2mpeg::encoder::mpeg2
