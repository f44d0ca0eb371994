#include "encoder/av/module/input.h"

#include <array>
#include <cstddef>
#include <fstream>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

/// libavformat's format for a file that begins as a transport stream does: with a packet of 188 bytes and the sync byte
/// after another [H222, 2.4.3.2]. Null for all others, which libavformat knows by their contents; a stream of a few
/// small pictures is too short for it.
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

}  // namespace

OpenStream open_stream(const std::string& file, AVMediaType kind, int error_recognition, const Messages& messages) {
    const auto refuse = [&](const std::string& cause) { throw core::Error("reading", file, cause); };
    AVFormatContext* input = avformat_alloc_context();
    if (input == nullptr) refuse(cause_of(AVERROR(ENOMEM), messages));
    input->error_recognition = error_recognition;
    // Playlists may name what they like: nothing but files is opened. The prefix keeps names with colons from being
    // taken for network addresses. On failure `input` is freed.
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    const int opened = avformat_open_input(&input, ("file:" + file).c_str(), transport_stream_format(file), &options);
    av_dict_free(&options);
    if (opened < 0) refuse(cause_of(opened, messages));
    OpenStream film{Input(input), nullptr};
    if (const int r = avformat_find_stream_info(input, nullptr); r < 0) refuse(cause_of(r, messages));
    const int stream = av_find_best_stream(input, kind, -1, -1, nullptr, 0);
    if (stream < 0) refuse(kind == AVMEDIA_TYPE_AUDIO ? "there is no sound in it" : "there is no video in it");
    film.stream = input->streams[stream];
    return film;
}

OpenStream open_film(const std::string& file, int error_recognition, const Messages& messages) {
    return open_stream(file, AVMEDIA_TYPE_VIDEO, error_recognition, messages);
}

}  // namespace render2mpeg::av
