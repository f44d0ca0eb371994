#include "image/png_chunks.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/error.h"

namespace render2mpeg::image {
namespace {

constexpr std::size_t signature_bytes = 8;

/// The check sum's table for one byte. [PNG, annex D]
constexpr std::array<std::uint32_t, 256> crc_table = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        std::uint32_t c = n;
        for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[n] = c;
    }
    return table;
}();

std::uint32_t crc_of(std::span<const std::byte> bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const std::byte b : bytes) crc = crc_table[(crc ^ std::to_integer<std::uint32_t>(b)) & 0xff] ^ (crc >> 8);
    return ~crc;
}

std::uint32_t big_endian(std::span<const std::byte> bytes) {
    std::uint32_t value = 0;
    for (const std::byte b : bytes.first(4)) value = value << 8 | std::to_integer<std::uint32_t>(b);
    return value;
}

}  // namespace

std::vector<std::byte> essential_png(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::array<std::string_view, 5> essential{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
    const auto refuse = [&](const std::string& cause) { throw core::Error("reading", name, cause); };
    std::vector<std::byte> kept(bytes.begin(), bytes.begin() + signature_bytes);
    bool has_pixels = false, has_shape = false;

    // Each chunk is four bytes of length, four of type, the content, four of check sum over type and content.
    for (std::span<const std::byte> rest = bytes.subspan(signature_bytes);;) {
        if (rest.size() < 12) refuse("the PNG file is cut off");
        const std::size_t length = big_endian(rest);
        if (length > rest.size() - 12) refuse("the PNG file is cut off");
        const std::span<const std::byte> chunk = rest.first(length + 12);
        const std::string type(reinterpret_cast<const char*>(chunk.data()) + 4, 4);
        rest = rest.subspan(chunk.size());

        const bool sound = crc_of(chunk.subspan(4, length + 4)) == big_endian(chunk.subspan(length + 8));
        if (type == "pHYs" && sound && length == 9 && !has_pixels && !has_shape) {
            kept.insert(kept.end(), chunk.begin(), chunk.end());
            has_shape = true;
        } else if (std::find(essential.begin(), essential.end(), type) != essential.end()) {
            if (!sound) refuse("the PNG file is damaged (check sum of " + type + ")");
            kept.insert(kept.end(), chunk.begin(), chunk.end());
            if (type == "IHDR" &&
                (length != 13 || big_endian(chunk.subspan(8)) == 0 || big_endian(chunk.subspan(12)) == 0))
                refuse("it has no pixels");
            has_pixels = has_pixels || type == "IDAT";
            if (type == "IEND") break;
        } else if ((chunk[4] & std::byte{0x20}) == std::byte{0}) {
            // The first letter is a capital: the pixels mean nothing without it.
            refuse("the PNG file is damaged or not standard (a chunk that must be understood is not known)");
        }
    }
    if (!has_pixels) refuse("it has no pixels");
    return kept;
}

}  // namespace render2mpeg::image
