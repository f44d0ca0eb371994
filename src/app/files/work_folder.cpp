#include "app/files/work_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "app/files/file_io.h"
#include "app/options/output_kind.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

std::string shown(const json& value) {
    if (value.is_null()) return "not given";
    return value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, json::error_handler_t::replace);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::filesystem::path& output) {
    std::string process;
    std::ifstream(file) >> process;
    throw OutputInUse("writing", output.string(),
                      "another run is writing it" + (process.empty() ? "" : " (process " + process + ")"));
}

/// Whether the open file still has its name: the last run may have removed it.
bool is_current(int descriptor, const std::filesystem::path& file) {
    struct stat opened {
    }, named{};
    return fstat(descriptor, &opened) == 0 && lstat(file.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

/// Whether a plain file has this name alone, so that writing changes nothing else.
bool is_plain(int descriptor) {
    struct stat opened {};
    return fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) && opened.st_nlink <= 1;
}

/// Whether a lock failed since the file system has none.
bool has_no_locks(int failure) {
    return failure == ENOLCK || failure == EOPNOTSUPP || failure == ENOSYS || failure == EINVAL;
}

std::string why_not_opened(int failure) {
    return failure == ELOOP ? "it is a link, which is not followed" : std::strerror(failure);
}

constexpr const char *lock_name = "lock", *manifest_name = "manifest.json";

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::vector<std::filesystem::path> entries;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) entries.push_back(entry.path());
    return entries;
}

/// Whether a work folder holds only a lock, or an unfinished first manifest.
bool holds_nothing(const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> entries = entries_of(folder);
    return std::ranges::all_of(entries, [](const std::filesystem::path& entry) {
        const std::string name = entry.filename().string();
        return name == lock_name || (name.starts_with(manifest_name) && name.ends_with(".tmp"));
    });
}

/// An empty object where there is none.
json manifest_in(const std::filesystem::path& folder) {
    json manifest = read_json(folder / manifest_name);
    return manifest.is_object() ? manifest : json::object();
}

/// JSON as read back: invalid UTF-8 is replaced.
json as_written(const json& value) {
    return json::parse(json_text(value));
}

std::string name_of(const Chunk& chunk, const std::string& of = {}) {
    return fmt::format("chunk_{:05}{}{}.m2v", chunk.index, of.empty() ? "" : ".", of);
}

/// Refuses another film's folder; without a manifest it holds nothing. A damaged manifest may still have good chunks.
void refuse_other(const std::filesystem::path& output, const json& identity) {
    const std::filesystem::path folder = work_folder_of(output);
    const json earlier = manifest_in(folder);
    if (earlier.empty() && !is_there(folder / manifest_name)) return;
    const std::string difference = earlier.empty() ? manifest_name + std::string(" is damaged in ") + folder.string()
                                                   : difference_of(earlier.value("identity", json()), identity);
    if (!difference.empty())
        throw core::Error("resuming", output.string(), difference + "; without --resume the film begins anew");
}

}  // namespace

std::string difference_of(const json& before, const json& now) {
    const json was = before.is_object() ? before.flatten() : json::object(), is = now.flatten();
    json all = was;
    all.update(is);
    for (const auto& [place, value] : all.items()) {
        const json a = was.value(place, json()), b = is.value(place, json());
        if (a == b) continue;
        const std::string name = json::json_pointer(place).back();
        if (place.starts_with("/inputs/"))
            return fmt::format("the input {} {}", name,
                               a.is_null()   ? "is new"
                               : b.is_null() ? "is gone"
                                             : "has changed");
        return fmt::format("{} was {} and is {}", name, shown(a), shown(b));
    }
    return {};
}

OutputLock::OutputLock(const std::filesystem::path& file, const std::filesystem::path& output, Locking locking) {
    // chosen: a dry run looks at the lock for some microseconds, and a run that ends removes its folder in
    // milliseconds; tries for 0.2 s bridge both.
    constexpr int tries = 20;
    constexpr auto pause = std::chrono::milliseconds(10);
    for (int left = tries; descriptor_ < 0; --left) {
        if (left < tries) std::this_thread::sleep_for(pause);
        std::error_code error;
        std::filesystem::create_directories(file.parent_path(), error);
        if (error) throw core::Error("writing", output.string(), error.message());
        descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (descriptor_ < 0 && errno == ENOENT && left > 0) continue;  // the folder went with the run before
        if (descriptor_ < 0) throw core::Error("writing", file.string(), why_not_opened(errno));
        const int failure = flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
        const bool taken = failure == 0 || (locking == Locking::where_possible && has_no_locks(failure));
        if (taken && is_current(descriptor_, file)) break;
        close(descriptor_);
        descriptor_ = -1;
        if (left > 0 && (taken || failure == EWOULDBLOCK)) continue;
        if (taken || failure == EWOULDBLOCK) refuse(file, output);
        throw core::Error("writing", output.string(), std::string("it cannot be locked: ") + std::strerror(failure));
    }

    if (!is_plain(descriptor_)) {
        close(descriptor_);
        throw core::Error("writing", file.string(), "it is no file of ours: another name leads to it, too");
    }
    // Name the holder; a lock without a name is valid too.
    const std::string process = std::to_string(getpid()) + "\n";
    const bool told = ftruncate(descriptor_, 0) == 0 && ::write(descriptor_, process.data(), process.size()) > 0;
    static_cast<void>(told);
}

OutputLock::~OutputLock() {
    close(descriptor_);
}

void OutputLock::check(const std::filesystem::path& file, const std::filesystem::path& output) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) return;
    const bool held = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(descriptor);
    if (held) refuse(file, output);
}

WorkFolder::WorkFolder(const std::filesystem::path& output, const json& identity, Earlier earlier, Locking locking)
    : folder_((check(output), work_folder_of(output))),
      locking_(locking),
      lock_(folder_ / lock_name, output, locking),
      manifest_(std::make_unique<json>(json{{"identity", as_written(identity)}})) {
    if (earlier == Earlier::resumed) refuse_other(output, (*manifest_)["identity"]);
    try {
        take_over(earlier);
    } catch (const std::filesystem::filesystem_error& error) {
        if (!resumed_) remove();
        throw core::Error("writing", folder_.string(), error.code().message());
    } catch (...) {
        if (!resumed_) remove();
        throw;
    }
}

void WorkFolder::take_over(Earlier earlier) {
    const json before = manifest_in(folder_);
    resumed_ = begun_ =
        earlier == Earlier::resumed && before.contains("identity") && before["identity"] == (*manifest_)["identity"];
    (*manifest_)["kept"] = resumed_ && before.contains("kept") ? before["kept"] : json::object();
    (*manifest_)["held"] = before.value("held", json::array());
    if (!resumed_) drop_all_but({});
    write_manifest();
}

void WorkFolder::hold(const std::filesystem::path& output) {
    // Remembered first: a later run finds it after a kill.
    json& held = (*manifest_)["held"];
    const std::string name = std::filesystem::absolute(output).lexically_normal().string();
    if (std::find(held.begin(), held.end(), name) == held.end()) held.push_back(name);
    write_manifest();
    held_.push_back(std::make_unique<WorkFolder>(output, nullptr, Earlier::removed, locking_));
}

WorkFolder::~WorkFolder() {
    if (!begun_) remove();
}

void WorkFolder::write_manifest() {
    write_whole(folder_ / manifest_name, json_text(*manifest_));
}

void WorkFolder::check(const std::filesystem::path& output) {
    const std::filesystem::path folder = work_folder_of(output);
    struct stat there {};
    if (lstat(folder.c_str(), &there) != 0) {
        if (errno == ENOENT) return;
        throw core::Error("writing", folder.string(), std::strerror(errno));
    }
    if (S_ISLNK(there.st_mode)) throw core::Error("writing", folder.string(), "it is a link, which is not followed");
    // Another user's folder may lead anywhere.
    if (there.st_uid != geteuid())
        throw core::Error("writing", folder.string(), "it belongs to another user, who may change what is in it");
    OutputLock::check(folder / lock_name, output);
    // Take only a folder with a manifest, or an empty one.
    const bool ours = S_ISDIR(there.st_mode) && (holds_nothing(folder) || is_there(folder / manifest_name));
    if (!ours)
        throw core::Error("writing", folder.string(),
                          "something of that name is in the way that is no unfinished film");
}

void WorkFolder::check(const std::filesystem::path& output, const json& identity) {
    check(output);
    refuse_other(output, as_written(identity));
}

std::vector<Chunk> WorkFolder::left(const std::filesystem::path& output, const json& identity,
                                    const std::vector<Chunk>& chunks) {
    std::vector<Chunk> left;
    if (!is_of(output, identity)) return left;
    for (const Chunk& chunk : chunks)
        if (is_there(record_of(output, chunk))) left.push_back(chunk);
    return left;
}

std::filesystem::path WorkFolder::record_of(const std::filesystem::path& output, const Chunk& chunk) {
    return ChunkFile::record_of(work_folder_of(output) / name_of(chunk));
}

bool WorkFolder::is_of(const std::filesystem::path& output, const json& identity) {
    const json manifest = manifest_in(work_folder_of(output));
    return manifest.contains("identity") && manifest["identity"] == as_written(identity);
}

std::vector<ChunkFile> WorkFolder::finished(const std::vector<Chunk>& chunks, const std::string& of) const {
    std::vector<ChunkFile> files;
    for (const Chunk& chunk : chunks) {
        std::optional<ChunkFile> file = ChunkFile::reopened(place(name_of(chunk, of)), chunk);
        if (file) files.push_back(std::move(*file));
    }
    return files;
}

std::filesystem::path WorkFolder::stream_of(const Chunk& chunk) const {
    return place(name_of(chunk));
}

std::filesystem::path WorkFolder::stream_of(const std::filesystem::path& output, const Chunk& chunk) {
    return work_folder_of(output) / name_of(chunk);
}

void WorkFolder::drop_all_but(const std::vector<ChunkFile>& chunks, const std::vector<Chunk>& in_the_making) {
    for (const std::filesystem::path& entry : entries_of(folder_)) {
        const std::string name = entry.filename().string();
        const bool own = name == lock_name || name == manifest_name;
        // Streams, records, frames and heatmaps of chunks.
        const bool wanted = std::ranges::any_of(
            chunks, [&](const ChunkFile& chunk) { return name.starts_with(chunk.file().stem().string() + "."); });
        const bool lit = std::ranges::any_of(in_the_making, [&](const Chunk& chunk) {
            const std::string stem = stream_of(chunk).stem().string();
            return name == stem + ".lit" || name == stem + ".state";
        });
        if (!own && !wanted && !lit) std::filesystem::remove_all(entry);
    }
}

json WorkFolder::kept(const std::string& name) const {
    return (*manifest_)["kept"].value(name, json());
}

void WorkFolder::keep(const std::string& name, const json& value) {
    (*manifest_)["kept"][name] = value;
    write_manifest();
}

std::filesystem::path WorkFolder::begin(const std::string& name) {
    begun_ = true;
    return place(name);
}

ChunkFile WorkFolder::open(const Chunk& chunk, const std::string& of) {
    begun_ = true;
    return {place(name_of(chunk, of)), chunk};
}

void WorkFolder::remove() {
    if (removed_) return;  // the present folder is the next run's
    held_.clear();
    std::vector<std::string> names;
    try {
        names = manifest_->value("held", names);
    } catch (const std::exception&) {
        names.clear();  // a damaged manifest holds none
    }
    for (const std::string& output : names) try {
            // One that is held still is another run's.
            if (is_of(output, nullptr)) WorkFolder(output, nullptr, Earlier::removed, locking_).remove();
        } catch (const std::exception&) {
        }
    // The lock comes last, since the rest may be the next run's without it. A leftover folder is harmless.
    std::error_code ignored;
    for (const std::filesystem::path& entry : entries_of(folder_))
        if (entry.filename() != lock_name && entry.filename() != manifest_name)
            std::filesystem::remove_all(entry, ignored);
    std::filesystem::remove(folder_ / manifest_name, ignored);
    std::filesystem::remove(folder_ / lock_name, ignored);
    std::filesystem::remove(folder_, ignored);
    removed_ = true;
}

}  // namespace render2mpeg::app
