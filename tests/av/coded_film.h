#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/rational.h"
#include "encoder/av/av.h"
#include "support/program.h"

/// Films to put into containers, made by ffmpeg's own encoder: a foreign stream with B pictures and every header that a
/// stranger writes.
namespace render2mpeg::test {

namespace fs = std::filesystem;
using support::Folder;

inline std::vector<std::uint8_t> bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

struct CodedPicture {
    std::vector<std::uint8_t> bytes;
    std::int64_t display_number = 0;
    bool starts_gop = false;
};

struct CodedFilm {
    encoder::Settings settings;
    std::vector<CodedPicture> pictures;  ///< in coding order
    std::size_t largest = 0;
    fs::path source;  ///< the elementary stream

    /// Writes all of it; returns the file.
    fs::path mux(const fs::path& file) const {
        av::Muxer muxer(file, file, settings, largest);
        std::int64_t order = 0;
        for (const CodedPicture& p : pictures) muxer.write(p.bytes, p.display_number, order++, p.starts_gop);
        muxer.finish();
        return file;
    }
};

/// Cuts an elementary stream into access units: each begins at its sequence header, GOP header or picture header.
inline std::vector<CodedPicture> access_units(const std::vector<std::uint8_t>& stream) {
    std::vector<CodedPicture> pictures;
    std::int64_t gop_begins = 0;
    std::size_t begin = 0;
    bool has_picture = false, is_gop = false;
    std::int64_t number = 0;
    const auto close = [&](std::size_t end) {
        if (has_picture)
            pictures.push_back({{stream.begin() + static_cast<std::ptrdiff_t>(begin),
                                 stream.begin() + static_cast<std::ptrdiff_t>(end)},
                                number,
                                is_gop});
        if (has_picture) begin = end, is_gop = false;
        has_picture = false;
    };
    for (std::size_t i = 0; i + 5 < stream.size(); ++i) {
        if (stream[i] != 0 || stream[i + 1] != 0 || stream[i + 2] != 1) continue;
        const std::uint8_t code = stream[i + 3];
        if (code == 0xb3 || code == 0xb8 || code == 0x00) close(i);
        if (code == 0xb8) {
            is_gop = true;
            gop_begins = static_cast<std::int64_t>(pictures.size());
        }
        if (code == 0x00) {
            has_picture = true;
            number = gop_begins + (stream[i + 4] << 2 | stream[i + 5] >> 6);
        }
    }
    close(stream.size());
    return pictures;
}

/// `options` are ffmpeg's for its mpeg2video encoder, e.g. "-g 12 -bf 2 -q:v 4"; `filter` changes its test pictures.
inline CodedFilm coded_film(const Folder& folder, int width, int height, const std::string& rate, int pictures,
                            const std::string& options, const std::string& filter = "") {
    const fs::path file = folder / "source.m2v";
    const core::FrameRate frame_rate = core::frame_rate_from(rate);
    const std::string hertz = std::to_string(frame_rate.hertz.num) + "/" + std::to_string(frame_rate.hertz.den);
    // testsrc2 makes even sizes only.
    const std::string size = std::to_string(width) + ":" + std::to_string(height);
    const std::string source = "testsrc2=size=" + std::to_string(width + width % 2) + "x" +
                               std::to_string(height + height % 2) + ":rate=" + hertz + ",format=yuv420p,crop=" + size +
                               ":0:0:exact=1" + (filter.empty() ? "" : "," + filter);
    const support::Outcome made =
        support::run("ffmpeg -v error -y -f lavfi -i '" + source + "' -frames:v " + std::to_string(pictures) +
                     " -c:v mpeg2video " + options + " -f mpeg2video " + file.string());
    if (made.status != 0) throw std::runtime_error(made.output);

    CodedFilm film;
    film.source = file;
    film.settings.width = width;
    film.settings.height = height;
    film.settings.rate = frame_rate;
    film.pictures = access_units(bytes_of(file));
    for (const CodedPicture& p : film.pictures) film.largest = std::max(film.largest, p.bytes.size());
    return film;
}

}  // namespace render2mpeg::test
