#include "app/files/publish.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "app/files/file_io.h"
#include "app/files/output_stream.h"
#include "app/options/output_kind.h"
#include "core/error.h"
#include "encoder/av/av.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// Muxes the access units of one chunk; the film's last picture carries the end code.
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

/// Throws core::Error unless every decoded picture equals its reconstruction bit for bit.
void verify(const std::filesystem::path& film, std::span<const ChunkFile> chunks) {
    std::vector<PictureRecord> expected;
    for (const ChunkFile& chunk : chunks)
        expected.insert(expected.end(), chunk.pictures().begin(), chunk.pictures().end());
    std::ranges::sort(expected, {}, &PictureRecord::number);

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

/// Pipes and character devices are written to, not replaced.
bool is_written_to(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    return std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
}

/// Whether files can be made in a folder: errno, or 0.
int failure_to_write_in(const std::filesystem::path& folder) {
    // An unnamed file goes with the process.
    const int descriptor = open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0600);
    if (descriptor >= 0) return close(descriptor) == 0 ? 0 : errno;
    // Not every file system has unnamed files; access rights were seen before.
    return errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL || errno == ENOENT ? 0 : errno;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    std::error_code error;
    return canonical_of(std::filesystem::absolute(file, error).parent_path());
}

bool same(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    return std::filesystem::equivalent(a, b, error) || canonical_of(a) == canonical_of(b);
}

bool holds(const FrameRange& frames, const std::optional<std::int64_t>& number) {
    return number && *number >= frames.first && *number <= frames.last;
}

/// Whether a file is one of a sequence's, by name or link.
bool is_of(const Files& sequence, const std::filesystem::path& file) {
    const std::filesystem::path led = canonical_of(file), folder = folder_of(sequence.name);
    return (folder_of(file) == folder && holds(*sequence.frames, number_in(sequence.name, file))) ||
           (led.parent_path() == folder && holds(*sequence.frames, number_in(sequence.name, led)));
}

bool meet(const Files& a, const Files& b) {
    if (!a.frames && !b.frames) return same(a.name, b.name);
    if (!a.frames) return is_of(b, a.name);
    if (!b.frames) return is_of(a, b.name);
    if (folder_of(a.name) != folder_of(b.name)) return false;
    // chosen: names that have no number in common in a million frames will have none later; a longer look takes
    // seconds.
    const std::int64_t last = std::min(a.frames->last, a.frames->first + 1'000'000);
    for (std::int64_t n = a.frames->first; n <= last; ++n)
        if (holds(*b.frames, number_in(b.name, numbered(a.name, n)))) return true;
    return false;
}

struct Doubt {
    std::filesystem::path file;
    std::string text;  ///< the conflict, and the effect of -y
};

bool holds_something(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::is_regular_file(file, error) && std::filesystem::file_size(file, error) > 0 && !error;
}

std::vector<Doubt> doubts_of(const Wishes& wishes) {
    std::vector<Doubt> doubts;
    std::vector<std::filesystem::path> all = wishes.beside;
    for (const Files& file : wishes.dear) {
        all.push_back(file.name);
        if (!file.frames && holds_something(file.name))
            doubts.push_back({file.name, "is there already; -y replaces it"});
        if (!file.frames) continue;
        const std::vector<std::int64_t> there = numbers_on_disk(file.name);
        const auto count = std::ranges::count_if(there, [&](std::int64_t n) { return holds(*file.frames, n); });
        if (count > 0)
            doubts.push_back({file.name, fmt::format("{} of these images are there already; -y replaces them", count)});
    }
    std::vector<std::filesystem::path> folders;
    for (const std::filesystem::path& file : all) {
        const std::filesystem::path folder = file.parent_path();
        if (file.empty() || folder.empty() || is_there(folder)) continue;
        if (std::ranges::find(folders, folder) != folders.end()) continue;
        folders.push_back(folder);
        doubts.push_back({file, "there is no folder " + folder.string() + "; -y makes it"});
    }
    return doubts;
}

}  // namespace

std::optional<av::Loudness> assemble(std::span<const ChunkFile> chunks, const Film& film,
                                     const std::filesystem::path& file, const std::filesystem::path& name) {
    std::size_t largest = 0;
    for (const ChunkFile& chunk : chunks)
        for (const PictureRecord& picture : chunk.pictures()) largest = std::max<std::size_t>(largest, picture.bytes);

    std::int64_t pictures = 0;
    for (const ChunkFile& chunk : chunks) pictures += std::ssize(chunk.pictures());
    av::Muxer muxer(file, name, film.coding, largest, film.disc ? av::ProgramStream::dvd : av::ProgramStream::plain,
                    film.sound_beside(pictures));
    std::int64_t coded_before = 0;
    for (const ChunkFile& chunk : chunks) {
        copy_chunk(chunk, muxer, film.coding.codec, film.frames.first, coded_before, &chunk == &chunks.back());
        coded_before += static_cast<std::int64_t>(chunk.pictures().size());
    }
    return muxer.finish();
}

void check_reachable(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    // Such as links in a circle.
    if (error && status.type() == std::filesystem::file_type::none)
        throw core::Error("writing", file.string(), error.message());
    if (std::filesystem::is_directory(status)) throw core::Error("writing", file.string(), "it is a folder");
    if (std::filesystem::is_block_file(status) || std::filesystem::is_socket(status))
        throw core::Error("writing", file.string(), "it is no file");
    // A protected file is not replaced.
    if (std::filesystem::exists(status) && access(file.c_str(), W_OK) != 0)
        throw core::Error("writing", file.string(), std::strerror(errno));
    if (is_written_to(file)) return;
    // Missing folders will be made in the last existing one.
    std::filesystem::path folder = std::filesystem::absolute(file, error).lexically_normal().parent_path();
    while (!std::filesystem::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    if (!std::filesystem::is_directory(folder, error))
        throw core::Error("writing", file.string(), folder.string() + " is not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw core::Error("writing", file.string(), folder.string() + ": " + std::strerror(errno));
}

void check_writable(const std::filesystem::path& file) {
    check_reachable(file);
    if (is_written_to(file)) return;
    std::error_code error;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error("writing", file.string(), error.message());
    if (const int failure = failure_to_write_in(folder); failure != 0)
        throw core::Error("writing", file.string(),
                          std::string("the folder cannot be written: ") + std::strerror(failure));
}

void check_apart(const std::vector<Files>& inputs, const std::vector<Files>& outputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (outputs[i].name.empty()) continue;
        for (const Files& input : inputs)
            if (!input.name.empty() && meet(outputs[i], input))
                throw core::Error("writing", outputs[i].name.string(), "it is an input: " + input.name.string());
        for (std::size_t j = 0; j < i; ++j)
            if (!outputs[j].name.empty() && meet(outputs[i], outputs[j]))
                throw core::Error("writing", outputs[i].name.string(),
                                  "two outputs have this name: " + outputs[j].name.string());
    }
}

Published publish(std::span<const ChunkFile> chunks, const Film& film, WorkFolder& work,
                  const std::filesystem::path& output, bool complete) {
    const std::filesystem::path file = work.begin("film" + output.extension().string());
    const std::optional<av::Loudness> loudness = assemble(chunks, film, file, output);
    verify(file, chunks);
    Published published = complete ? give_name(file, output) : published_at(file);
    published.loudness = loudness;
    return published;
}

Published published_at(const std::filesystem::path& file) {
    std::error_code error;
    return {file, std::filesystem::file_size(file, error), {}};
}

Published give_name(const std::filesystem::path& file, const std::filesystem::path& output) {
    std::error_code error;
    const Published whole{output, std::filesystem::file_size(file, error), {}};
    if (is_written_to(output)) {
        std::ifstream from(file, std::ios::binary);
        write_into(output, from);
        return whole;
    }
    bring_to_disk(file);
    std::filesystem::rename(file, output, error);
    if (error == std::errc::cross_device_link) return place(file, output), whole;
    if (error) throw core::Error("writing", output.string(), error.message());
    bring_name_to_disk(output);
    return whole;
}

void place(const std::filesystem::path& from, const std::filesystem::path& to) {
    const std::filesystem::path beside = std::filesystem::path(to) += ".joining";
    std::error_code error;
    std::filesystem::remove(beside, error);
    std::filesystem::create_hard_link(from, beside, error);
    // Another file system, or one without such links.
    if (error) std::filesystem::copy_file(from, beside, std::filesystem::copy_options::overwrite_existing, error);
    if (!error) bring_to_disk(beside);
    if (!error) std::filesystem::rename(beside, to, error);
    if (error) throw core::Error("writing", to.string(), error.message());
    // A name that is the same file's already takes no other's place.
    std::filesystem::remove(beside, error);
}

void require_consent(const Wishes& wishes, bool agreed) {
    if (agreed) return;
    for (const Doubt& doubt : doubts_of(wishes)) throw core::Error("writing", doubt.file.string(), doubt.text);
}

std::vector<std::string> doubts_about(const Wishes& wishes) {
    std::vector<std::string> lines;
    for (const Doubt& doubt : doubts_of(wishes)) lines.push_back(doubt.file.string() + ": " + doubt.text);
    return lines;
}

}  // namespace render2mpeg::app
