#pragma once
// Decides every macroblock of a row by distortion + lambda * bits: the mode decision.
#include <cstdint>
#include <vector>

#include "encoder/mpeg2/macroblock/macroblock.h"

/// Decides how each macroblock is coded: skipped, inter or intra.
namespace render2mpeg::encoder::mpeg2 {

/// A row of macroblocks, decided and reconstructed but not yet written: only then are the picture's best tables and
/// f_codes known.
struct RowCode {
    std::vector<MacroblockCode> macroblocks;
    int quantiser = 1;                ///< of the slice's header
    std::vector<RunLevel> runs;       ///< of all blocks, in their order
    std::int64_t table_one_gain = 0;  ///< bits saved by coding intra blocks with table B-15
    std::uint64_t evaluations = 0;    ///< 16x16 differences computed to choose modes, skipping and intra
    std::uint64_t searches = 0;       ///< 16x16 sums of absolute differences of Effort::fast's search
};

/// Decides every macroblock of a row by distortion + lambda * bits, and reconstructs it. `vectors` has one per
/// macroblock of the row for each direction; not read for a direction that the picture has no reference in.
/// `quantisers` has the quantiser_scale_code of every macroblock.
RowCode decide_row(const PictureCoding& picture, int row, const std::uint8_t* quantisers,
                   const BestVectors* const (&vectors)[2]);

}  // namespace render2mpeg::encoder::mpeg2
