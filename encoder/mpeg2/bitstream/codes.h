#pragma once

#include <array>
#include <cstdint>

#include "encoder/mpeg2/bitstream/bit_writer.h"
#include "encoder/types.h"

/// Code words and scan of ISO/IEC 13818-2. All of it is fact of the standard; a test has foreign decoders read every
/// code.
namespace render2mpeg::encoder::mpeg2 {

/// Order of coefficients in the stream: raster position v * 8 + u of the i-th. [H262, figure 7-2]
inline constexpr std::array<std::uint8_t, 64> zigzag = {0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,
                                                        12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
                                                        35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,
                                                        58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

/// macroblock_address_increment 1..33; index 0 is macroblock_escape (33 more). [H262, table B-1]
extern const std::array<Code, 34> address_increment_codes;

/// coded_block_pattern for 4:2:0; bit 5 is the first luma block, bit 0 is Cr. Pattern 0 has no use here. [H262, table
/// B-9]
extern const std::array<Code, 64> pattern_codes;

/// motion_code magnitude 0..16, without the sign bit that follows a magnitude above 0 (1: negative). [H262, table B-10]
extern const std::array<Code, 17> motion_codes;

/// dct_dc_size 0..11. [H262, tables B-12 and B-13]
extern const std::array<Code, 12> luma_dc_size_codes;
extern const std::array<Code, 12> chroma_dc_size_codes;

/// Code words of runs and levels, sign bit not included.
struct CoefficientCodes {
    static constexpr int runs = 32;
    static constexpr int levels = 41;
    Code code[runs][levels];  ///< [run][|level|]; length 0: escape
    Code end_of_block;
};

/// Non-intra blocks, and intra ones with intra_vlc_format 0. The first coefficient of a non-intra block has code `1` in
/// the place of `11` for run 0, level 1. [H262, table B-14]
const CoefficientCodes& coefficient_codes_zero();
/// Intra blocks with intra_vlc_format 1. [H262, table B-15]
const CoefficientCodes& coefficient_codes_one();

inline constexpr Code coefficient_escape{0b000001, 6};  ///< then 6 bits of run, 12 of level [H262, table B-16]
inline constexpr int escape_bits = 24;

/// macroblock_type as flags [H262, tables B-2 to B-4].
struct MacroblockType {
    bool intra = false;
    bool motion_forward = false;
    bool pattern = false;
    bool quant = false;
    bool motion_backward = false;

    bool motion(int direction) const { return direction == 0 ? motion_forward : motion_backward; }
};
/// Length 0 where the picture type has no such macroblock.
Code macroblock_type_code(PictureType picture, const MacroblockType& type);

}  // namespace render2mpeg::encoder::mpeg2
