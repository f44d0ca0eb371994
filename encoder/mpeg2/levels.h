#pragma once

#include <cstdint>
#include <span>

#include "encoder/encoder.h"

namespace render2mpeg::encoder::mpeg2 {

/// What a level of Main Profile allows. [H262, tables 8-11 to 8-14]
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

/// The lowest of Main, High-1440 and High level that allows size and rate. Throws core::Error, naming the limit, where
/// none does or a setting is out of its range.
const Level& level_for(const Settings& settings);

/// Bits that a 4:2:0 macroblock should not exceed. The standard lets two per row of macroblocks exceed it; we let none.
/// [H262, 8.5]
inline constexpr std::uint32_t macroblock_bits_limit = 4608;

/// Whether pictures of these sizes can be decoded with a buffer of a level's size that fills at the level's rate
/// whenever it is not full (vbv_delay 0xFFFF). [H262, annex C]
class BufferWatch {
  public:
    BufferWatch(const Level& level, const core::FrameRate& rate);
    /// Takes a picture out; false where it had not arrived whole. The buffer then goes on empty.
    bool remove(std::uint64_t bits);
    /// Bits held now, before the next picture is taken out.
    double fullness() const { return fullness_; }

  private:
    double size_;
    double per_picture_;
    double fullness_;
};

}  // namespace render2mpeg::encoder::mpeg2
