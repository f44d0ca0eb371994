#pragma once
// The limits of MPEG-2's levels, and the lowest level that a film fits.
#include <cstdint>
#include <span>

#include "encoder/types.h"

/// Main Profile's levels and their limits; rate and VBV size of a stream.
namespace render2mpeg::encoder::mpeg2 {

/// Limits of a level of Main Profile. [H262, tables 8-11 to 8-14]
struct Level {
    const char* name;
    int indication;            ///< level_identification, 4 bits
    int width, height;         ///< largest picture
    int hertz;                 ///< highest picture rate
    std::int64_t samples;      ///< luma samples per second, of whole macroblocks
    std::int64_t bit_rate;     ///< bits per second, a multiple of 400
    std::int64_t buffer_bits;  ///< VBV size, a multiple of 16384
    int horizontal_f_code;     ///< highest f_code; the highest vertical one is 5 everywhere
};

inline constexpr int vertical_f_code_limit = 5;

/// All of them, the lowest first.
std::span<const Level> all_levels();

/// The lowest of Main, High-1440 and High level that allows size, rates and buffer. Throws core::Error, naming the
/// limit, where none does or a setting is out of its range.
const Level& level_for(const Settings& settings);

/// Macroblocks of a picture from top to bottom: where pictures are fields, each field has whole ones.
/// [H262, 6.3.3: mb_height]
int macroblock_rows(const Settings& settings);

/// Delivery of a stream's bits to a decoder, as declared in its headers.
struct Channel {
    bool constant;                ///< the rate; else it is the highest one
    std::int64_t bit_rate;        ///< bits per second, a multiple of 400 as the header counts
    std::int64_t buffer_bits;     ///< a multiple of 16384 likewise
    std::int64_t usable_bits;     ///< usable part of it: with a constant rate limited by the range of vbv_delay
    std::int64_t chunk_fullness;  ///< fullness before the first picture of a chunk is taken out
    std::int64_t average_rate;    ///< wanted; the highest where none is
};

/// The wanted rates and buffer, rounded down to what headers can say, or the level's.
Channel channel_for(const Settings& settings, const Level& level);

/// Bits that a 4:2:0 macroblock should not exceed. The standard lets two per row of macroblocks exceed it; we let none.
/// [H262, 8.5]
inline constexpr std::uint32_t macroblock_bits_limit = 4608;

}  // namespace render2mpeg::encoder::mpeg2
