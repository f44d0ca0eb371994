#include "app/files/checksum.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/error.h"

namespace render2mpeg::app {

std::uint64_t checksum_of(const core::Picture& picture) {
    Checksum sum;
    for (const core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr}) sum.add(plane->values());
    return sum.value();
}

std::uint64_t checksum_of(const std::filesystem::path& file) {
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> buffer(1 << 16);
    Checksum sum;
    while (stream) {
        stream.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(buffer.size()));
        sum.add(std::span(buffer).first(static_cast<std::size_t>(stream.gcount())));
    }
    if (!stream.eof()) throw core::Error("reading", file.string(), errno != 0 ? std::strerror(errno) : "it ends early");
    return sum.value();
}

std::string text_of(std::uint64_t checksum) {
    return fmt::format("{:016x}", checksum);
}

}  // namespace render2mpeg::app
