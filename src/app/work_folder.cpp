#include "app/work_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "app/output_kind.h"
#include "core/error.h"
#include "encoder/av/av.h"

namespace render2mpeg::app {
namespace {

constexpr const char *lock_name = "lock", *manifest_name = "manifest.json";

/// Writes a small text file so that it is there whole or not at all.
void write_whole(const std::filesystem::path& path, const std::string& text) {
    const std::filesystem::path temporary = path.string() + ".tmp";
    {
        std::ofstream stream(temporary, std::ios::binary);
        stream << text;
        stream.close();
        if (!stream) throw core::Error("writing", path.string(), "the disk is full or the folder cannot be written");
    }
    std::filesystem::rename(temporary, path);
}

nlohmann::json record_of(const PictureRecord& picture) {
    return {{"number", picture.number},
            {"coding_order", picture.coding_order},
            {"starts_gop", picture.starts_gop},
            {"bytes", picture.bytes},
            {"checksum", fmt::format("{:016x}", picture.checksum)}};
}

/// Hands the access units of one chunk to the muxer, in coding order. The film's last picture carries the end code with
/// it.
void copy_chunk(const ChunkFile& chunk, av::Muxer& muxer, std::int64_t first_frame, std::int64_t coded_before,
                bool last_chunk) {
    std::ifstream stream(chunk.file(), std::ios::binary);
    std::vector<std::uint8_t> bytes;
    for (const PictureRecord& picture : chunk.pictures()) {
        bytes.resize(picture.bytes);
        stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        if (!stream)
            throw core::Error("reading", chunk.file().string(), "the file is shorter than it was when it was written");
        if (last_chunk && &picture == &chunk.pictures().back())
            for (const std::uint8_t byte : encoder::sequence_end()) bytes.push_back(byte);
        muxer.write(bytes, picture.number - first_frame, coded_before + picture.coding_order, picture.starts_gop);
    }
}

}  // namespace

std::uint64_t checksum_of(const core::Picture& picture) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (const core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr})
        for (const std::uint8_t value : plane->values()) hash = (hash ^ value) * 0x100000001b3ull;
    return hash;
}

ChunkFile::ChunkFile(const std::filesystem::path& file, const Chunk& chunk)
    : file_(file), chunk_(chunk), stream_(file, std::ios::binary | std::ios::trunc) {
    if (!stream_) throw core::Error("writing", file_.string(), "the folder cannot be written");
}

void ChunkFile::append(const encoder::CodedPicture& coded) {
    stream_.write(reinterpret_cast<const char*>(coded.bytes.data()), static_cast<std::streamsize>(coded.bytes.size()));
    if (!stream_) throw core::Error("writing", file_.string(), "the disk is full");
    if (pictures_.empty()) vbv_in_ = coded.fullness_before;
    vbv_out_ = coded.fullness_next;
    pictures_.push_back({coded.plan.number, static_cast<std::int64_t>(pictures_.size()), coded.plan.starts_gop,
                         coded.bytes.size(), checksum_of(coded.reconstruction)});
}

void ChunkFile::finish(const std::vector<FrameEntry>& frames) {
    abandon();
    nlohmann::json record{{"first", chunk_.first}, {"last", chunk_.last}, {"pictures", nlohmann::json::array()}};
    for (const PictureRecord& picture : pictures_) record["pictures"].push_back(record_of(picture));
    std::uint64_t bits = 0;
    for (const FrameEntry& frame : frames) bits += 8 * frame.bytes;
    record["bits"] = bits;
    record["vbv_in"] = vbv_in_;
    record["vbv_out"] = vbv_out_;
    write_whole(std::filesystem::path(file_).replace_extension(".json"), record.dump(1) + "\n");
}

void ChunkFile::abandon() {
    stream_.close();
    if (!stream_) throw core::Error("writing", file_.string(), "the disk is full");
}

WorkFolder::WorkFolder(const std::filesystem::path& output, const Film& film, const std::string& command)
    : folder_((check(output), work_folder_of(output))), lock_(folder_ / lock_name, output) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, error))
        if (entry.path().filename() != lock_name) std::filesystem::remove_all(entry.path(), error);
    if (error) throw core::Error("writing", folder_.string(), error.message());

    write_whole(folder_ / manifest_name, nlohmann::json{{"version", RENDER2MPEG_VERSION},
                                                        {"command", command},
                                                        {"input", film.source},
                                                        {"frames", {film.frames.first, film.frames.last}},
                                                        {"isa", film.isa}}
                                                 .dump(1) +
                                             "\n");
}

WorkFolder::~WorkFolder() {
    if (!begun_) remove();
}

void WorkFolder::check(const std::filesystem::path& output) {
    const std::filesystem::path folder = work_folder_of(output);
    if (!std::filesystem::exists(folder)) return;
    OutputLock::check(folder / lock_name, output);
    // Take only a folder that is ours to empty: one with a manifest, or none yet.
    std::error_code error;
    bool ours = std::filesystem::is_directory(folder, error), empty = true;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        empty = empty && entry.path().filename() == lock_name;
    ours = ours && (empty || std::filesystem::exists(folder / manifest_name));
    if (!ours)
        throw core::Error("writing", folder.string(),
                          "something of that name is in the way that is no unfinished film");
}

std::filesystem::path WorkFolder::begin(const std::string& name) {
    begun_ = true;
    return folder_ / name;
}

ChunkFile WorkFolder::open(const Chunk& chunk) {
    return {begin(fmt::format("chunk_{:05}.m2v", chunk.index)), chunk};
}

void WorkFolder::remove() {
    std::error_code ignored;  // the film is whole; a leftover folder harms nobody
    std::filesystem::remove_all(folder_, ignored);
}

void assemble(const std::vector<ChunkFile>& chunks, const Film& film, const std::filesystem::path& file,
              const std::filesystem::path& name) {
    std::size_t largest = 0;
    for (const ChunkFile& chunk : chunks)
        for (const PictureRecord& picture : chunk.pictures()) largest = std::max<std::size_t>(largest, picture.bytes);

    av::Muxer muxer(file, name, film.coding, largest, film.disc ? av::ProgramStream::dvd : av::ProgramStream::plain);
    std::int64_t coded_before = 0;
    for (const ChunkFile& chunk : chunks) {
        copy_chunk(chunk, muxer, film.frames.first, coded_before, &chunk == &chunks.back());
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
