#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/picture.h"

namespace render2mpeg::app {

/// A 64-bit checksum of bytes, which may come in pieces [FNV]. It tells damage and change, not forgery.
class Checksum {
  public:
    void add(std::span<const std::uint8_t> bytes) {
        for (const std::uint8_t byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3ull;
    }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

/// Of a picture's three planes.
std::uint64_t checksum_of(const core::Picture& picture);

/// Of all that a file holds. Throws core::Error.
std::uint64_t checksum_of(const std::filesystem::path& file);

/// 16 hexadecimal digits.
std::string text_of(std::uint64_t checksum);

}  // namespace render2mpeg::app
