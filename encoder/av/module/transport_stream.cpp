#include "encoder/av/module/transport_stream.h"

#include <array>
#include <cstddef>
#include <fstream>

namespace render2mpeg::av {

const AVInputFormat* transport_stream_format(const std::string& file) {
    // chosen: the tables and a picture take three packets; eight in a row are no accident.
    constexpr std::size_t packet = 188, fewest = 3, most = 8;
    constexpr char sync_byte = 0x47;
    std::array<char, most * packet> start;
    std::ifstream stream(file, std::ios::binary);
    stream.read(start.data(), start.size());
    const std::size_t packets = static_cast<std::size_t>(stream.gcount()) / packet;
    if (packets < fewest) return nullptr;
    for (std::size_t i = 0; i < packets; ++i)
        if (start[i * packet] != sync_byte) return nullptr;
    return av_find_input_format("mpegts");
}

}  // namespace render2mpeg::av
