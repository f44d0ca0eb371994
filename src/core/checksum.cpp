#include "core/checksum.h"

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

std::string checksum_text(std::uint64_t checksum) {
    std::string text(16, '0');
    for (std::size_t k = 0; k < text.size(); ++k) text[k] = "0123456789abcdef"[(checksum >> (60 - 4 * k)) & 15];
    return text;
}

}  // namespace render2mpeg::core
