#include "app/files/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "core/error.h"
#include "encoder/av/av.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// Hands the access units of one chunk to the muxer, in coding order. The film's last picture carries the end code with
/// it.
void copy_chunk(const ChunkFile& chunk, av::Muxer& muxer, encoder::Codec codec, std::int64_t first_frame,
                std::int64_t coded_before, bool last_chunk) {
    std::ifstream stream(chunk.file(), std::ios::binary);
    std::vector<std::uint8_t> bytes;
    for (const PictureRecord& picture : chunk.pictures()) {
        bytes.resize(picture.bytes);
        stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        if (!stream)
            throw core::Error("reading", chunk.file().string(), "the file is shorter than it was when it was written");
        if (last_chunk && &picture == &chunk.pictures().back())
            for (const std::uint8_t byte : encoder::end_of_stream(codec)) bytes.push_back(byte);
        muxer.write(bytes, picture.number - first_frame, coded_before + picture.coding_order, picture.starts_gop);
    }
}

}  // namespace

void assemble(const std::vector<ChunkFile>& chunks, const Film& film, const std::filesystem::path& file,
              const std::filesystem::path& name) {
    std::size_t largest = 0;
    for (const ChunkFile& chunk : chunks)
        for (const PictureRecord& picture : chunk.pictures()) largest = std::max<std::size_t>(largest, picture.bytes);

    std::size_t pictures = 0;
    for (const ChunkFile& chunk : chunks) pictures += chunk.pictures().size();
    av::Sound sound = film.sound;
    sound.seconds = static_cast<double>(pictures) / film.coding.rate.hertz.value();
    av::Muxer muxer(file, name, film.coding, largest, film.disc ? av::ProgramStream::dvd : av::ProgramStream::plain,
                    sound);
    std::int64_t coded_before = 0;
    for (const ChunkFile& chunk : chunks) {
        copy_chunk(chunk, muxer, film.coding.codec, film.frames.first, coded_before, &chunk == &chunks.back());
        coded_before += static_cast<std::int64_t>(chunk.pictures().size());
    }
    muxer.finish();
}

void verify(const std::filesystem::path& film, const std::vector<ChunkFile>& chunks) {
    std::vector<PictureRecord> expected;
    for (const ChunkFile& chunk : chunks)
        expected.insert(expected.end(), chunk.pictures().begin(), chunk.pictures().end());
    std::sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) { return a.number < b.number; });

    std::size_t decoded = 0;
    av::decode(film, [&](const core::Picture& picture) {
        if (decoded >= expected.size() || checksum_of(picture) != expected[decoded].checksum)
            throw core::Error("verifying", film.string(),
                              fmt::format("picture {} does not decode to what was encoded", decoded));
        ++decoded;
    });
    if (decoded != expected.size())
        throw core::Error("verifying", film.string(),
                          fmt::format("{} of {} pictures decode", decoded, expected.size()));
}

}  // namespace render2mpeg::app
