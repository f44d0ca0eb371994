#include "app/files/chunk_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"

namespace render2mpeg::app {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PictureRecord, number, coding_order, starts_gop, bytes, checksum)

namespace {

using nlohmann::json;

/// The record's list; none where a number in it is no whole one.
std::optional<std::vector<PictureRecord>> pictures_from(const json& list) {
    const auto is_fit = [](const json& value) { return value.is_boolean() || value.is_number_integer(); };
    for (const json& picture : list)
        if (!std::ranges::all_of(picture, is_fit)) return {};
    return list.get<std::vector<PictureRecord>>();
}

std::string reason() {
    return errno != 0 ? std::strerror(errno) : "the disk is full";
}

}  // namespace

ChunkFile::ChunkFile(const std::filesystem::path& file, const Chunk& chunk)
    : file_(file), chunk_(chunk), stream_(file, std::ios::binary | std::ios::trunc) {
    if (!stream_) throw core::Error("writing", file_.string(), "the folder cannot be written");
}

ChunkFile::ChunkFile(std::filesystem::path file, const Chunk& chunk, std::vector<PictureRecord> pictures)
    : file_(std::move(file)), chunk_(chunk), pictures_(std::move(pictures)) {}

std::optional<ChunkFile> ChunkFile::reopened(const std::filesystem::path& file, const Chunk& chunk) {
    const json record = read_json(record_of(file));
    try {
        if (!record.is_object() || record.at("first") != chunk.first || record.at("last") != chunk.last) return {};
        std::optional<std::vector<PictureRecord>> pictures = pictures_from(record.at("pictures"));
        if (!pictures) return {};
        std::uint64_t left = std::filesystem::file_size(file);
        for (const PictureRecord& picture : *pictures) {
            if (picture.bytes > left) return {};
            left -= picture.bytes;
        }
        const bool sound = left == 0 && record.at("checksum") == text_of(checksum_of(file)) && record.contains("facts");
        if (!sound) return {};
        return ChunkFile(file, chunk, *std::move(pictures));
    } catch (const std::exception&) {
        return {};  // a record that is none, or a stream that is gone
    }
}

void ChunkFile::append(const encoder::CodedPicture& coded) {
    errno = 0;
    stream_.write(reinterpret_cast<const char*>(coded.bytes.data()), static_cast<std::streamsize>(coded.bytes.size()));
    if (!stream_) throw core::Error("writing", file_.string(), reason());
    checksum_.add(coded.bytes);
    pictures_.push_back({coded.plan.number, static_cast<std::int64_t>(pictures_.size()), coded.plan.starts_gop,
                         coded.bytes.size(), checksum_of(coded.reconstruction)});
}

void ChunkFile::finish(const json& facts) {
    abandon();
    bring_to_disk(file_);  // its record must not outlive it
    const json record{{"first", chunk_.first},
                      {"last", chunk_.last},
                      {"pictures", pictures_},
                      {"facts", facts},
                      {"checksum", text_of(checksum_.value())}};
    write_whole(record_of(file_), record.dump() + "\n");
}

void ChunkFile::abandon(std::int64_t lit) {
    lit_ = lit;
    errno = 0;
    stream_.close();
    if (!stream_) throw core::Error("writing", file_.string(), reason());
}

json ChunkFile::facts() const {
    const json record = read_json(record_of(file_));
    if (!record.is_object() || !record.contains("facts"))
        throw core::Error("reading", record_of(file_).string(), "it is no record of a chunk");
    return record["facts"];
}

std::filesystem::path ChunkFile::record_of(const std::filesystem::path& file) {
    return std::filesystem::path(file).replace_extension(".json");
}

bool is_whole(const ChunkFile& chunk) {
    return is_there(ChunkFile::record_of(chunk.file()));
}

std::span<const ChunkFile> leading_of(std::span<const ChunkFile> files, int first) {
    std::size_t count = 0;
    for (bool goes_on = true; goes_on && count < files.size();) {
        const bool follows = index_of(files[count]) == first + static_cast<int>(count);
        goes_on = follows && is_whole(files[count]);
        count += follows ? 1 : 0;
    }
    return files.first(count);
}

}  // namespace render2mpeg::app
