#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/error.h"

namespace render2mpeg::encoder::mpeg2 {

/// A code word: its `length` lowest bits, most significant first.
struct Code {
    std::uint32_t bits = 0;
    std::uint8_t length = 0;  ///< 0: no such code word
};

/// Bits to bytes, most significant bit first.
class BitWriter {
  public:
    /// Appends the `count` (0..32) lowest bits of `value`; higher bits must be 0.
    void put(std::uint32_t value, int count) {
        EXPECTS_DEBUG(count >= 0 && count <= 32 && (count == 32 || (value >> count) == 0));
        held_ = (held_ << count) | value;
        held_count_ += count;
        while (held_count_ >= 8) {
            held_count_ -= 8;
            bytes_.push_back(static_cast<std::uint8_t>(held_ >> held_count_));
        }
    }
    void put(Code code) { put(code.bits, code.length); }

    /// Appends zero bits up to the next whole byte.
    void align() {
        if (held_count_ > 0) put(0, 8 - held_count_);
    }

    /// A start code: aligned, prefix 00 00 01, then its value. [H262, 6.2.1]
    void start_code(std::uint8_t value) {
        align();
        put(0x000001, 24);
        put(value, 8);
    }

    std::size_t bit_count() const { return bytes_.size() * 8 + static_cast<std::size_t>(held_count_); }
    /// What was written; only after align().
    const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    std::vector<std::uint8_t> take() { return std::move(bytes_); }
    void reserve(std::size_t byte_count) { bytes_.reserve(byte_count); }

  private:
    std::vector<std::uint8_t> bytes_;
    std::uint64_t held_ = 0;  ///< the `held_count_` lowest bits are not in bytes_ yet; higher ones are stale
    int held_count_ = 0;      ///< 0..7 between calls
};

}  // namespace render2mpeg::encoder::mpeg2
