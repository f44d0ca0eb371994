#include "scene/model/png.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "core/checksum.h"
#include "core/error.h"

namespace render2mpeg::scene {
namespace {

using Bytes = std::vector<std::byte>;

void put(Bytes& to, std::initializer_list<int> bytes) {
    for (const int byte : bytes) to.push_back(static_cast<std::byte>(byte));
}

void put_big_endian(Bytes& to, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

void put_chunk(Bytes& png, std::string_view type, const Bytes& content) {
    put_big_endian(png, static_cast<std::uint32_t>(content.size()));
    const auto first = static_cast<std::ptrdiff_t>(png.size());
    for (const char c : type) png.push_back(static_cast<std::byte>(c));
    png.insert(png.end(), content.begin(), content.end());
    put_big_endian(png, core::crc_of(std::span(png.begin() + first, png.end())));
}

/// zlib's format [RFC1950] with stored blocks alone [RFC1951].
Bytes stored(const Bytes& content) {
    constexpr std::size_t longest = 65'535;
    Bytes zlib;
    put(zlib, {0x78, 0x01});
    for (std::size_t at = 0; at < content.size(); at += longest) {
        const std::size_t length = std::min(longest, content.size() - at);
        const auto low = static_cast<int>(length & 0xff), high = static_cast<int>(length >> 8);
        put(zlib, {at + length == content.size() ? 1 : 0, low, high, 0xff - low, 0xff - high});
        const auto from = content.begin() + static_cast<std::ptrdiff_t>(at);
        zlib.insert(zlib.end(), from, from + static_cast<std::ptrdiff_t>(length));
    }
    std::uint32_t a = 1, b = 0;
    for (const std::byte byte : content) {
        a = (a + std::to_integer<std::uint32_t>(byte)) % 65'521;
        b = (b + a) % 65'521;
    }
    put_big_endian(zlib, b << 16 | a);
    return zlib;
}

}  // namespace

std::vector<std::byte> encode_png(int width, int height, std::span<const glm::u8vec4> texels) {
    EXPECTS(width > 0 && height > 0 && width <= 65'535 && height <= 65'535);
    EXPECTS(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    Bytes png, header, rows;
    put(png, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
    put_big_endian(header, static_cast<std::uint32_t>(width));
    put_big_endian(header, static_cast<std::uint32_t>(height));
    put(header, {8, 6, 0, 0, 0});  // bits, RGBA; rows as they are, one after the other [PNG, 11.2.2]
    const std::span<const std::byte> bytes = std::as_bytes(texels);
    const std::size_t row = sizeof(glm::u8vec4) * static_cast<std::size_t>(width);
    for (std::size_t at = 0; at < bytes.size(); at += row) {
        put(rows, {0});
        rows.insert(rows.end(), &bytes[at], &bytes[at] + row);
    }
    put_chunk(png, "IHDR", header);
    put_chunk(png, "IDAT", stored(rows));
    put_chunk(png, "IEND", {});
    return png;
}

}  // namespace render2mpeg::scene
