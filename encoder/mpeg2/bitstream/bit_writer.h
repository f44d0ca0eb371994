#pragma once
// Writes code words into bytes.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/error.h"

/// Writes code words and start codes.
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
        if (held_count_ >= 32) write_word();
    }
    void put(Code code) { put(code.bits, code.length); }

    /// Appends zero bits up to the next whole byte.
    void align() {
        if (held_count_ % 8 > 0) put(0, 8 - held_count_ % 8);
        make_room();
        for (; held_count_ > 0; held_count_ -= 8)
            bytes_[size_++] = static_cast<std::uint8_t>(held_ >> (held_count_ - 8));
    }

    /// A start code: aligned, prefix 00 00 01, then its value. [H262, 6.2.1]
    void start_code(std::uint8_t value) {
        align();
        put(0x000001, 24);
        put(value, 8);
    }

    std::size_t bit_count() const { return size_ * 8 + static_cast<std::size_t>(held_count_); }
    /// The bytes written; only after align(), and as the last call.
    std::vector<std::uint8_t> take() {
        bytes_.resize(size_);
        return std::move(bytes_);
    }

  private:
    /// For four bytes.
    void make_room() {
        if (size_ + 4 > bytes_.size()) bytes_.resize(2 * size_ + 64);
    }
    /// Moves the 32 bits held longest to the bytes.
    void write_word() {
        make_room();
        held_count_ -= 32;
        const auto word = static_cast<std::uint32_t>(held_ >> held_count_);
        for (std::size_t i = 0; i < 4; ++i) bytes_[size_ + i] = static_cast<std::uint8_t>(word >> (24 - 8 * i));
        size_ += 4;
    }

    std::vector<std::uint8_t> bytes_;  ///< the first size_ are written
    std::size_t size_ = 0;
    std::uint64_t held_ = 0;  ///< the `held_count_` lowest bits are not in bytes_ yet; higher ones are stale
    int held_count_ = 0;      ///< 0..31 between calls
};

}  // namespace render2mpeg::encoder::mpeg2
