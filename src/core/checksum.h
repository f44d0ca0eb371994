#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace render2mpeg::core {

/// A 64-bit checksum of bytes, which may come in pieces [FNV]. It tells damage and change, not forgery.
class Checksum {
  public:
    void add(std::span<const std::uint8_t> bytes) {
        for (const std::uint8_t byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3ull;
    }
    void add(std::string_view text) { add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
    /// Of all that a file holds. Throws core::Error.
    void add_file(const std::filesystem::path& file);
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

/// Of all that a file holds. Throws core::Error.
std::uint64_t checksum_of(const std::filesystem::path& file);

/// The check sum of PNG's chunks [PNG, annex D].
std::uint32_t crc_of(std::span<const std::byte> bytes);

/// 16 hexadecimal digits.
std::string checksum_text(std::uint64_t checksum);

}  // namespace render2mpeg::core
