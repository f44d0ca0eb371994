#pragma once
// Unpacks what OpenEXR files pack by ZIP, which OpenEXR 3.1 does four times as slowly.
#include <cstdint>
#include <memory>
#include <span>

struct libdeflate_decompressor;

namespace render2mpeg::image {

/// Unpacks chunks of scan lines, one after the other.
class ZipUnpacker {
  public:
    ZipUnpacker();

    /// Fills `bytes` with bytes 0, 2, 4 ... of the chunk first, and bytes 1, 3, 5 ... then. False where `packed` is no
    /// chunk of that size.
    bool unpack(std::span<const char> packed, std::span<std::uint8_t> bytes);

  private:
    std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflate_;
};

}  // namespace render2mpeg::image
