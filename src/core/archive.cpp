#include "core/archive.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/plain_file.h"

namespace render2mpeg::core {

void ArchiveBlocks::sum_up() {
    auto* const end = reinterpret_cast<unsigned char*>(block_.data());
    std::fill(end + used_, end + (used_ + 7) / 8 * 8, static_cast<unsigned char>(0));
    for (std::size_t i = 0; i < (used_ + 7) / 8; ++i) checksum_ = (checksum_ ^ block_[i]) * 0x100000001b3ull;
    // Words' upper bits reach the lower ones.
    checksum_ ^= checksum_ >> 32;
}

ArchiveWriter::ArchiveWriter(const std::filesystem::path& file, std::uint64_t mark)
    : file_(file), part_(std::filesystem::path(file) += ".tmp"), mark_(mark) {
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);  // which may be a link or a pipe
    stream_.open(part_, std::ios::binary);
    const Header none;
    stream_.write(reinterpret_cast<const char*>(&none), sizeof none);
}

ArchiveWriter::~ArchiveWriter() {
    std::error_code ignored;
    if (!part_.empty()) std::filesystem::remove(part_, ignored);
}

void ArchiveWriter::bytes(const void* from, std::size_t count) {
    const auto* at = static_cast<const char*>(from);
    total_ += count;
    while (count > 0) {
        const std::size_t now = std::min(count, sizeof block_ - used_);
        std::memcpy(reinterpret_cast<char*>(block_.data()) + used_, at, now);
        used_ += now;
        at += now;
        count -= now;
        if (used_ == sizeof block_) flush();
    }
}

void ArchiveWriter::flush() {
    sum_up();
    stream_.write(reinterpret_cast<const char*>(block_.data()), static_cast<std::streamsize>(used_));
    used_ = 0;
}

void ArchiveWriter::finish() {
    flush();
    const Header header{mark_, total_, checksum_};
    stream_.seekp(0);
    stream_.write(reinterpret_cast<const char*>(&header), sizeof header);
    stream_.close();
    std::error_code error;
    if (stream_) std::filesystem::rename(part_, file_, error);
    if (!stream_ || error) throw Error("writing", file_.string(), error ? error.message() : "the disk is full");
    part_.clear();
}

std::unique_ptr<ArchiveReader> ArchiveReader::open(const std::filesystem::path& file, std::uint64_t mark) {
    std::unique_ptr<ArchiveReader> reader(new ArchiveReader);
    ArchiveReader& r = *reader;
    r.file_ = file;
    if (!why_no_plain_file(file).empty()) return nullptr;
    r.stream_.open(file, std::ios::binary);
    Header header;
    r.stream_.read(reinterpret_cast<char*>(&header), sizeof header);
    if (!r.stream_ || header.mark != mark) return nullptr;
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(file, error);
    if (error || bytes - sizeof header != header.bytes) return nullptr;
    // All of it is proved before a byte of it is believed.
    std::uint64_t left = r.left_ = header.bytes;
    do {
        r.used_ = static_cast<std::size_t>(std::min<std::uint64_t>(left, sizeof r.block_));
        r.stream_.read(reinterpret_cast<char*>(r.block_.data()), static_cast<std::streamsize>(r.used_));
        if (!r.stream_) return nullptr;
        r.sum_up();
        left -= r.used_;
    } while (r.used_ == sizeof r.block_);
    if (r.checksum_ != header.checksum) return nullptr;
    r.stream_.seekg(sizeof header);
    r.used_ = 0;
    return reader;
}

void ArchiveReader::fill() {
    stream_.read(reinterpret_cast<char*>(block_.data()), sizeof block_);
    used_ = static_cast<std::size_t>(stream_.gcount());
    given_ = 0;
}

void ArchiveReader::bytes(void* to, std::size_t count) {
    if (count > left_) throw Error("reading", file_.string(), "it ends too early");
    left_ -= count;
    auto* at = static_cast<char*>(to);
    while (count > 0) {
        if (given_ == used_) fill();
        if (used_ == 0) throw Error("reading", file_.string(), "it ends too early");
        const std::size_t now = std::min(count, used_ - given_);
        std::memcpy(at, reinterpret_cast<const char*>(block_.data()) + given_, now);
        given_ += now;
        at += now;
        count -= now;
    }
}

std::size_t ArchiveReader::count(std::size_t least) {
    std::uint64_t count = 0;
    (*this)(count);
    expect(count, least);
    return static_cast<std::size_t>(count);
}

void ArchiveReader::expect(std::uint64_t values, std::size_t bytes) const {
    if (values > left_ / bytes) throw Error("reading", file_.string(), "it ends too early");
}

}  // namespace render2mpeg::core
