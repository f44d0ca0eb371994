#include "scene/model/png.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "core/checksum.h"
#include "core/error.h"

namespace render2mpeg::scene {
namespace {

using Bytes = std::vector<std::byte>;

void put(Bytes& to, std::uint32_t big_endian) {
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<std::byte>(big_endian >> shift));
}

void put_chunk(Bytes& to, std::string_view type, std::span<const std::byte> content) {
    put(to, static_cast<std::uint32_t>(content.size()));
    const std::size_t from = to.size();
    for (const char c : type) to.push_back(static_cast<std::byte>(c));
    to.insert(to.end(), content.begin(), content.end());
    put(to, core::crc_of(std::span(to).subspan(from)));
}

/// A zlib stream of stored blocks. [RFC1950; RFC1951, 3.2.4]
Bytes zlib_stored(std::span<const std::byte> raw) {
    Bytes out{std::byte{0x78}, std::byte{0x01}};
    constexpr std::size_t longest = 65535;
    for (std::size_t at = 0; at < raw.size(); at += longest) {
        const std::size_t n = std::min(longest, raw.size() - at);
        out.push_back(static_cast<std::byte>(at + n == raw.size() ? 1 : 0));
        for (const std::size_t v : {n, ~n}) {
            out.push_back(static_cast<std::byte>(v & 0xff));
            out.push_back(static_cast<std::byte>((v >> 8) & 0xff));
        }
        out.insert(out.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                   raw.begin() + static_cast<std::ptrdiff_t>(at + n));
    }
    std::uint32_t a = 1, b = 0;
    for (const std::byte v : raw) {
        a = (a + static_cast<std::uint32_t>(v)) % 65521;
        b = (b + a) % 65521;
    }
    put(out, b << 16 | a);
    return out;
}

}  // namespace

Bytes encode_png(int width, int height, std::span<const glm::u8vec4> texels) {
    EXPECTS(width > 0 && height > 0);
    EXPECTS(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));

    // Every row opens with its filter: none.
    Bytes raw;
    for (int y = 0; y < height; ++y) {
        raw.push_back(std::byte{0});
        for (int x = 0; x < width; ++x) {
            const glm::u8vec4 t =
                texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
            for (int k = 0; k < 4; ++k) raw.push_back(static_cast<std::byte>(t[k]));
        }
    }
    Bytes header;
    put(header, static_cast<std::uint32_t>(width));
    put(header, static_cast<std::uint32_t>(height));
    for (const int v : {8, 6, 0, 0, 0}) header.push_back(static_cast<std::byte>(v));  // 8 bits, RGBA, not interlaced

    Bytes png;
    for (const int v : {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a}) png.push_back(static_cast<std::byte>(v));
    put_chunk(png, "IHDR", header);
    put_chunk(png, "IDAT", zlib_stored(raw));
    put_chunk(png, "IEND", {});
    return png;
}

}  // namespace render2mpeg::scene
