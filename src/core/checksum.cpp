#include "core/checksum.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/error.h"

namespace render2mpeg::core {

void Checksum::add_file(const std::filesystem::path& file) {
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> buffer(1 << 16);
    while (stream) {
        stream.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(buffer.size()));
        add(std::span(buffer).first(static_cast<std::size_t>(stream.gcount())));
    }
    if (!stream.eof()) throw Error("reading", file.string(), errno != 0 ? std::strerror(errno) : "it ends early");
}

std::uint64_t checksum_of(const std::filesystem::path& file) {
    Checksum sum;
    sum.add_file(file);
    return sum.value();
}

std::uint32_t crc_of(std::span<const std::byte> bytes) {
    static constexpr std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> values{};
        for (std::uint32_t n = 0; n < 256; ++n) {
            std::uint32_t c = n;
            for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
            values[n] = c;
        }
        return values;
    }();
    std::uint32_t crc = 0xffffffffu;
    for (const std::byte b : bytes) crc = table[(crc ^ std::to_integer<std::uint32_t>(b)) & 0xff] ^ (crc >> 8);
    return ~crc;
}

std::string checksum_text(std::uint64_t checksum) {
    std::string text(16, '0');
    for (std::size_t k = 0; k < text.size(); ++k) text[k] = "0123456789abcdef"[(checksum >> (60 - 4 * k)) & 15];
    return text;
}

}  // namespace render2mpeg::core
