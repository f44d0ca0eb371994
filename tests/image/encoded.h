#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

/// Image files written byte by byte from their specifications, so that what is read does not depend on who wrote it.
namespace render2mpeg::image::encoded {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& to, const Bytes& what) {
    to.insert(to.end(), what.begin(), what.end());
}
inline void append(Bytes& to, const std::string& what) {
    to.insert(to.end(), what.begin(), what.end());
}
inline void append_big(Bytes& to, std::uint32_t v, int bytes = 4) {
    for (int i = bytes - 1; i >= 0; --i) to.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
}
inline void append_little(Bytes& to, std::uint32_t v, int bytes) {
    for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
}

/// PNG's check sum. [PNG, annex D]
inline std::uint32_t crc_of(const Bytes& bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const std::uint8_t byte : bytes) {
        crc ^= byte;
        for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return ~crc;
}

inline void append_chunk(Bytes& png, const std::string& type, const Bytes& content) {
    append_big(png, static_cast<std::uint32_t>(content.size()));
    Bytes checked;
    append(checked, type);
    append(checked, content);
    append(png, checked);
    append_big(png, crc_of(checked));
}

/// zlib's format without compression: one stored block of at most 65535 bytes. [RFC1950], [RFC1951]
inline Bytes stored(const Bytes& content) {
    Bytes zlib{0x78, 0x01, 0x01};
    append_little(zlib, static_cast<std::uint32_t>(content.size()), 2);
    append_little(zlib, ~static_cast<std::uint32_t>(content.size()), 2);
    append(zlib, content);
    std::uint32_t a = 1, b = 0;
    for (const std::uint8_t byte : content) {
        a = (a + byte) % 65521;
        b = (b + a) % 65521;
    }
    append_big(zlib, b << 16 | a);
    return zlib;
}

struct Chunk {
    std::string type;
    Bytes content;
};

/// `color_type`: 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha. `rows` hold the packed samples without
/// filter bytes; `extra` chunks stand before the pixels.
inline Bytes png(std::uint32_t width, std::uint32_t height, int bits, int color_type, const std::vector<Bytes>& rows,
                 const std::vector<Chunk>& extra = {}) {
    Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    Bytes header;
    append_big(header, width);
    append_big(header, height);
    append(header, Bytes{static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(color_type), 0, 0, 0});
    append_chunk(file, "IHDR", header);
    for (const Chunk& chunk : extra) append_chunk(file, chunk.type, chunk.content);
    Bytes filtered;
    for (const Bytes& row : rows) {
        filtered.push_back(0);
        append(filtered, row);
    }
    append_chunk(file, "IDAT", stored(filtered));
    append_chunk(file, "IEND", {});
    return file;
}

/// An uncompressed true-colour TGA; `descriptor` 0x20: the first row is the upper one, 8: eight bits of alpha. Samples
/// are blue, green, red.
inline Bytes tga(int width, int height, int bits, int descriptor, const Bytes& samples) {
    Bytes file{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    append_little(file, static_cast<std::uint32_t>(width), 2);
    append_little(file, static_cast<std::uint32_t>(height), 2);
    append(file, Bytes{static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(descriptor)});
    append(file, samples);
    return file;
}

/// A 24-bit BMP, rows from below upwards, blue, green, red, padded to four bytes.
inline Bytes bmp(std::uint32_t width, std::uint32_t height, const std::vector<Bytes>& rows_upwards) {
    Bytes pixels;
    for (const Bytes& row : rows_upwards) {
        append(pixels, row);
        while (pixels.size() % 4 != 0) pixels.push_back(0);
    }
    Bytes file{'B', 'M'};
    append_little(file, static_cast<std::uint32_t>(54 + pixels.size()), 4);
    append_little(file, 0, 4);
    append_little(file, 54, 4);
    append_little(file, 40, 4);
    append_little(file, width, 4);
    append_little(file, height, 4);
    append_little(file, 1, 2);
    append_little(file, 24, 2);
    for (int i = 0; i < 6; ++i) append_little(file, 0, 4);
    append(file, pixels);
    return file;
}

/// A Radiance file without run lengths; pixels are mantissas and an exponent: mantissa / 256 x 2^(exponent - 128).
inline Bytes hdr(int width, int height, const Bytes& rgbe) {
    Bytes file;
    append(file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) +
                     "\n");
    append(file, rgbe);
    return file;
}

/// A baseline grey JPEG of 8x8 pixels, all 228: one DC coefficient of 100 x 8, no others. [T81]
inline Bytes grey_jpeg() {
    Bytes file{0xff, 0xd8};
    append(file, Bytes{0xff, 0xdb, 0, 67, 0});
    append(file, Bytes(64, 8));
    append(file, Bytes{0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0});
    for (const std::uint8_t table : {0x00, 0x10}) {  // one code of one bit: category 7 for DC, end of block for AC
        append(file, Bytes{0xff, 0xc4, 0, 20, table, 1});
        append(file, Bytes(15, 0));
        file.push_back(table == 0 ? 7 : 0);
    }
    append(file, Bytes{0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0});
    append(file, Bytes{0x64, 0x7f});  // 0, 1100100, 0, then ones
    append(file, Bytes{0xff, 0xd9});
    return file;
}

}  // namespace render2mpeg::image::encoded
