#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace render2mpeg::av {

/// Reads bits, most significant first; zeros past the end, and then `overrun` is true.
class Bits {
  public:
    explicit Bits(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::uint32_t read(int count) {
        std::uint32_t value = 0;
        for (int i = 0; i < count; ++i, ++position_) {
            const std::size_t byte = position_ / 8;
            value = value << 1 | (byte < bytes_.size() ? bytes_[byte] >> (7 - position_ % 8) & 1u : 0u);
        }
        return value;
    }
    bool flag() { return read(1) != 0; }
    void skip(std::size_t count) { position_ += count; }
    std::size_t position() const { return position_; }
    bool overrun() const { return position_ > 8 * bytes_.size(); }

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

}  // namespace render2mpeg::av
