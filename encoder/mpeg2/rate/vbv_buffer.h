#pragma once

#include <cstdint>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/types.h"

namespace render2mpeg::encoder::mpeg2 {

/// The buffer of the standard's ideal decoder, in exact arithmetic. [H262, annex C]
///
/// Bits come at the declared rate; each picture is taken out whole at its time. With a variable rate (vbv_delay 0xFFFF)
/// they stop coming while the buffer is full; with a constant rate they never stop, so that a buffer that would run
/// over asks for stuffing. Fullness is counted in fractions of a bit, 1 / (2 * numerator of the frame rate): what
/// arrives during a field is a whole number of them.
class VbvBuffer {
  public:
    VbvBuffer(const Settings& settings, const Channel& channel);

    /// Begins with the fullness that every chunk begins with, before its first picture `number` is taken out. With a
    /// constant rate all chunks together are then one unbroken stream of whole bytes: the fraction of a byte that has
    /// arrived at that time is counted in.
    void start_chunk(std::int64_t number);
    /// The fullness, in fractions, that the chunk which begins with `number` expects.
    std::int64_t chunk_fullness(std::int64_t number) const;

    /// Removes a picture of `bits` and lets `fields` pass. Returns the number of stuffing bytes to add to the picture:
    /// enough to prevent overflow, or with `next_chunk` enough to reach exactly the fullness expected by the next
    /// chunk. The picture must have arrived whole.
    std::int64_t take(std::int64_t bits, int fields, const std::int64_t* next_chunk = nullptr);

    std::int64_t fullness() const { return fullness_; }  ///< fractions
    std::int64_t capacity() const { return capacity_; }  ///< fractions
    std::int64_t arrivals(int fields) const { return per_field_ * fields; }
    /// Of bits.
    std::int64_t fractions(std::int64_t bits) const { return bits * per_bit_; }
    std::int64_t whole_bits(std::int64_t fractions) const { return fractions / per_bit_; }

    /// vbv_delay of a picture that is next to be taken out, in periods of 90 kHz: from the arrival of the last bit of
    /// its picture_start_code, before which `bits` of it come, until it is taken out. [H262, 6.3.9]
    int delay(std::int64_t bits) const;

  private:
    bool constant_;
    std::int64_t per_bit_;
    std::int64_t per_field_;
    std::int64_t capacity_;
    std::int64_t chunk_fullness_;
    std::int64_t rate_;
    Cadence cadence_;
    std::int64_t first_number_;
    std::int64_t fullness_;
};

/// Fields from the removal of the picture with coding order `order`, counted over the film, to the next one's.
int fields_after(const Settings& settings, std::int64_t order);

}  // namespace render2mpeg::encoder::mpeg2
