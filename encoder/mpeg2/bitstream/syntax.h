#pragma once
// Writes the headers above the macroblock: sequence, GOP, picture, slice.
#include <cstdint>
#include <span>
#include <vector>

#include "encoder/cadence.h"
#include "encoder/mpeg2/bitstream/bit_writer.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/matrices.h"
#include "encoder/types.h"

/// The layers above the macroblock. [H262, 6.2]
namespace render2mpeg::encoder::mpeg2 {

inline constexpr int start_code_bits = 32;

/// Sequence header, sequence extension, sequence display extension and user data. Bit rate and buffer size are
/// channel_for's; matrices other than the default ones are sent.
void write_sequence(BitWriter& out, const Settings& settings, const Level& level, const Matrices& matrices);

/// Header of a GOP whose first picture in display order is `first_number`: an I picture, if it is closed. The time code
/// counts frames at the rounded declared rate from the film's start (Labels), or from 0.
void write_gop(BitWriter& out, const Settings& settings, std::int64_t first_number, bool closed);

/// Contents of a picture's header and coding extension; progressive frame pictures with frame prediction and frame DCT
/// only.
struct PictureHeader {
    int temporal_reference = 0;  ///< display number within the GOP
    PictureType type = PictureType::intra;
    /// [direction][axis], 1..9: forward and backward, horizontal and vertical; 15: no vectors.
    int f_code[2][2] = {{15, 15}, {15, 15}};
    int intra_dc_bits = 8;  ///< precision of intra DC, 8..10
    bool intra_vlc_format = false;
    ShownFields shown;
};
void write_picture_header(BitWriter& out, const PictureHeader& header);

/// Changes vbv_delay, 0..0xffff, of a picture whose bytes begin with its start code; it was written as 0xffff.
void set_vbv_delay(std::span<std::uint8_t> picture, int delay);

/// Adds `count` zero bytes before the first slice of such a picture. Zeros may stand before every start code
/// [H262, 5.2.3]; behind a slice strict decoders take them for bits that are left over.
void add_stuffing(std::vector<std::uint8_t>& picture, std::size_t count);

/// Start of the slice of macroblock row `row` in a picture of `lines` lines.
void write_slice_header(BitWriter& out, int lines, int row, int quantiser);

}  // namespace render2mpeg::encoder::mpeg2
