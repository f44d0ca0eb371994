#pragma once

#include "encoder/mpeg2/bitstream/bit_writer.h"
#include "encoder/mpeg2/macroblock/mode_decision.h"

/// Writes a decided row of macroblocks as a slice.
namespace render2mpeg::encoder::mpeg2 {

/// Inputs of the writer besides a row's code.
struct SliceSyntax {
    PictureType type;
    int lines;
    int row;
    int quantiser;  ///< of the slice's header
    int f_code[2][2];
    bool intra_vlc_format;
    int dc_bits = 8;
};

/// Writes the row as one slice, whole bytes; notes the bits of every macroblock in its code.
void write_slice(BitWriter& out, const SliceSyntax& syntax, RowCode& code);

}  // namespace render2mpeg::encoder::mpeg2
