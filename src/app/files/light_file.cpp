#include "app/files/light_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

constexpr std::string_view magic = "render2mpeg light\n";

/// chosen: 1 GiB, 7 million places; a run that begins with it takes three times as much memory while it is read.
constexpr std::size_t most_bytes = std::size_t{1} << 30;

/// Before each block of a light file, and before its identity.
struct BlockHead {
    std::uint64_t bytes = 0, checksum = 0;
};

std::uint64_t checksum_of_text(std::string_view text) {
    Checksum sum;
    sum.add(text);
    return sum.value();
}

std::string block_of(std::string_view content) {
    const BlockHead head{content.size(), checksum_of_text(content)};
    return std::string(reinterpret_cast<const char*>(&head), sizeof(head)).append(content);
}

/// The block at a place of a file's text; empty where it is not whole there. Moves the place behind it.
std::string_view block_at(std::string_view text, std::size_t& place) {
    BlockHead head;
    if (text.size() < place + sizeof(head)) return {};
    std::memcpy(&head, text.data() + place, sizeof(head));
    if (head.bytes > text.size() - place - sizeof(head)) return {};
    const std::string_view block = text.substr(place + sizeof(head), head.bytes);
    if (checksum_of_text(block) != head.checksum) return {};
    place += sizeof(head) + block.size();
    return block;
}

/// An open file under its lock; others wait.
class LockedFile {
  public:
    explicit LockedFile(const std::filesystem::path& file)
        : file_(file), descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
        if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) fail();
    }
    ~LockedFile() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    LockedFile(const LockedFile&) = delete;
    LockedFile& operator=(const LockedFile&) = delete;

    std::size_t size() const {
        struct stat found {};
        if (fstat(descriptor_, &found) != 0) fail();
        return static_cast<std::size_t>(found.st_size);
    }
    /// Of its device and on it.
    std::array<std::uint64_t, 2> number() const {
        struct stat found {};
        if (fstat(descriptor_, &found) != 0) fail();
        return {found.st_dev, found.st_ino};
    }
    /// All from a place on.
    std::string text(std::size_t place) const {
        std::string text(size() - place, '\0');
        std::size_t read = 0;
        while (read < text.size()) {
            const ssize_t more =
                pread(descriptor_, text.data() + read, text.size() - read, static_cast<off_t>(place + read));
            if (more <= 0) fail();
            read += static_cast<std::size_t>(more);
        }
        return text;
    }
    /// Writes text from a place on, and ends the file there.
    void write(std::size_t place, std::string_view text) const {
        if (ftruncate(descriptor_, static_cast<off_t>(place)) != 0) fail();
        while (!text.empty()) {
            const ssize_t written = pwrite(descriptor_, text.data(), text.size(), static_cast<off_t>(place));
            if (written <= 0) fail();
            place += static_cast<std::size_t>(written);
            text.remove_prefix(static_cast<std::size_t>(written));
        }
        if (fsync(descriptor_) != 0 && errno != EINVAL) fail();
    }

  private:
    [[noreturn]] void fail() const { throw core::Error("writing", file_.string(), std::strerror(errno)); }

    std::filesystem::path file_;
    int descriptor_;
};

}  // namespace

LightFile::LightFile(const std::filesystem::path& file, const nlohmann::json& identity)
    : file_(canonical_of(file)),
      identity_(std::make_shared<const nlohmann::json>(nlohmann::json::parse(json_text(identity)))) {}

/// Bytes of a file that are whole, by its text `from` a block on.
std::size_t LightFile::whole_of(std::string_view text, std::size_t from) const {
    std::size_t place = 0;
    if (from == 0) {
        place = magic.size();
        if (magic.starts_with(text)) return 0;
        if (!text.starts_with(magic)) throw core::Error("reading", file_.string(), "it is no light file");
        const auto identity = parsed_json(block_at(text, place));
        if (identity.is_discarded()) return 0;
        if (const std::string difference = difference_of(identity, *identity_); !difference.empty())
            throw core::Error("reading", file_.string(), "it has other light: " + difference);
    }
    while (place < text.size() && !block_at(text, place).empty()) {
    }
    return from + place;
}

LightExtent LightFile::extent() const {
    if (!is_there(file_)) return {};
    if (!is_file(file_)) throw core::Error("reading", file_.string(), "it is no file");
    const std::string text = file_text(file_);
    const std::size_t whole = whole_of(text);
    return whole == 0 ? LightExtent{} : LightExtent{whole, checksum_of_text(std::string_view(text).substr(0, whole))};
}

std::vector<std::byte> LightFile::known(const LightExtent& beginning) const {
    if (beginning.bytes == 0) return {};
    const std::string text = is_there(file_) ? file_text(file_) : std::string();
    if (text.size() < beginning.bytes ||
        checksum_of_text(std::string_view(text).substr(0, beginning.bytes)) != beginning.checksum)
        throw core::Error("reading", file_.string(),
                          "it is another than when the film was begun: put that back, or begin the film anew");
    std::vector<std::byte> light;
    light.reserve(beginning.bytes);
    std::size_t place = magic.size();
    block_at(text, place);
    while (place < beginning.bytes) {
        const auto block = std::as_bytes(std::span(block_at(text, place)));
        if (block.empty()) break;
        light.insert(light.end(), block.begin(), block.end());
    }
    return light;
}

void LightFile::add(std::span<const std::byte> light) {
    if (light.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(file_.parent_path(), error);
    const LockedFile file(file_);
    // What this run saw whole need not be read again, in the same file.
    const bool is_same = file.number() == number_ && file.size() >= added_to_;
    const std::size_t from = is_same ? added_to_ : 0, whole = whole_of(file.text(from), from);
    if (whole + light.size() > most_bytes) throw core::Error("writing", file_.string(), "it is full: 1 GiB");
    std::string block = block_of({reinterpret_cast<const char*>(light.data()), light.size()});
    if (whole == 0) block = std::string(magic) + block_of(json_text(*identity_)) + block;
    file.write(whole, block);
    added_to_ = whole + block.size();
    number_ = file.number();
}

}  // namespace render2mpeg::app
