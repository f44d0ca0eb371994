#pragma once
// Cuts a PNG file down to the chunks that are safe to decode.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace render2mpeg::image {

/// A PNG file with nothing but its pixels and their shape: the chunks IHDR, PLTE, tRNS, IDAT and IEND, and pHYs where
/// it is sound. What a file says about colours is ignored by decree [glTF2, 3.8.3], and libpng prints to the terminal
/// what it thinks of profiles and of damage. Throws core::Error, naming the file, where a chunk is cut off, its check
/// sum is wrong, or a chunk is needed that nobody knows.
std::vector<std::byte> essential_png(std::span<const std::byte> bytes, const std::string& name);

}  // namespace render2mpeg::image
