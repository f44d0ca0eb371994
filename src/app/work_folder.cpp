#include "app/work_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "app/output_kind.h"
#include "app/text_file.h"
#include "core/error.h"
#include "encoder/av/av.h"

namespace render2mpeg::app {
namespace {

constexpr const char *lock_name = "lock", *manifest_name = "manifest.json";

/// A file as it was left: another size or time is another file.
nlohmann::json leftover_of(const std::filesystem::path& file) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (error) return nullptr;
    const auto written = std::filesystem::last_write_time(file, error).time_since_epoch().count();
    if (error) return nullptr;
    return {{"file", file.filename().string()}, {"bytes", bytes}, {"written", static_cast<std::int64_t>(written)}};
}

/// What says which film it is: the command, where it was given, and what it came to.
nlohmann::json identity_of(const Film& film, const std::string& command) {
    std::error_code error;
    return {{"version", RENDER2MPEG_VERSION},
            {"command", command},
            {"folder", std::filesystem::current_path(error).string()},
            {"input", film.source},
            {"frames", {film.frames.first, film.frames.last}},
            {"isa", film.isa}};
}

/// What is in a folder, as a list that may be worked off.
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::vector<std::filesystem::path> entries;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) entries.push_back(entry.path());
    return entries;
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
    write_whole(std::filesystem::path(file_).replace_extension(".json"), json_text(record));
}

void ChunkFile::abandon() {
    stream_.close();
    if (!stream_) throw core::Error("writing", file_.string(), "the disk is full");
}

WorkFolder::WorkFolder(const std::filesystem::path& output, const Film& film, const std::string& command)
    : output_(output),
      folder_((check(output), work_folder_of(output))),
      lock_(folder_ / lock_name, output),
      // As it will be read again: what is no UTF-8 is replaced.
      manifest_(std::make_unique<nlohmann::json>(nlohmann::json::parse(json_text(identity_of(film, command))))) {
    try {
        nlohmann::json leftovers = earlier_leftovers();
        (*manifest_)["leftovers"] = std::move(leftovers);
        for (const std::filesystem::path& entry : entries_of(folder_))
            if (entry.filename() != lock_name && entry.filename() != manifest_name) std::filesystem::remove_all(entry);
        write_manifest();
    } catch (const std::filesystem::filesystem_error& error) {
        remove();
        throw core::Error("writing", folder_.string(), error.code().message());
    } catch (...) {
        remove();
        throw;
    }
}

WorkFolder::~WorkFolder() {
    if (!begun_ && (*manifest_)["leftovers"].empty()) remove();
}

nlohmann::json WorkFolder::earlier_leftovers() const {
    std::ifstream stream(folder_ / manifest_name);
    nlohmann::json earlier = nlohmann::json::parse(stream, nullptr, false);
    if (!earlier.is_object()) return nlohmann::json::array();
    nlohmann::json leftovers = earlier.value("leftovers", nlohmann::json::array());
    earlier.erase("leftovers");
    return earlier == *manifest_ && leftovers.is_array() ? leftovers : nlohmann::json::array();
}

void WorkFolder::write_manifest() {
    write_whole(folder_ / manifest_name, json_text(*manifest_));
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
    return place(name);
}

ChunkFile WorkFolder::open(const Chunk& chunk) {
    return {begin(fmt::format("chunk_{:05}.m2v", chunk.index)), chunk};
}

std::filesystem::path WorkFolder::leave(const std::filesystem::path& file) {
    std::error_code error;
    std::filesystem::path name = partial_film_of(output_);
    for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(name, error)); ++i)
        name = partial_film_of(output_, i);
    std::filesystem::rename(file, name, error);
    if (error) throw core::Error("writing", name.string(), error.message());
    (*manifest_)["leftovers"].push_back(leftover_of(name));
    write_manifest();
    return name;
}

void WorkFolder::clear_away() {
    const std::filesystem::path folder = output_.parent_path();
    for (const nlohmann::json& leftover : (*manifest_)["leftovers"]) {
        if (!leftover.is_object() || !leftover.contains("file") || !leftover["file"].is_string()) continue;
        // Only a name, whatever the record says.
        const std::filesystem::path name = std::filesystem::path(leftover["file"].get<std::string>()).filename();
        std::error_code ignored;
        if (leftover == leftover_of(folder / name)) std::filesystem::remove(folder / name, ignored);
    }
    remove();
}

void WorkFolder::remove() {
    if (removed_) return;  // what is there now is the next run's
    // The lock comes last: without it, what is there may be the next run's. The manifest until then says that the
    // folder is ours. The film is whole; a leftover folder harms nobody.
    std::error_code ignored;
    for (const std::filesystem::path& entry : entries_of(folder_))
        if (entry.filename() != lock_name && entry.filename() != manifest_name)
            std::filesystem::remove_all(entry, ignored);
    std::filesystem::remove(folder_ / manifest_name, ignored);
    std::filesystem::remove(folder_ / lock_name, ignored);
    std::filesystem::remove(folder_, ignored);
    removed_ = true;
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
