#pragma once
// Trellis quantisation: the levels of a block by rate and distortion, with real code lengths.
#include "encoder/mpeg2/macroblock/block_coding.h"

/// RDOQ of a whole block at once, by a trellis.
namespace render2mpeg::encoder::mpeg2 {

/// Makes each level what quantisation made it, one less, or 0, so that distortion + lambda * bits of the whole block,
/// with real code lengths, is the least there is.
void trellis_rdoq(Block& block, const QuantTable& table, const CoefficientLengths& lengths, bool intra, float lambda);

}  // namespace render2mpeg::encoder::mpeg2
