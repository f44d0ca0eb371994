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
#include <string_view>
#include <system_error>
#include <thread>

#include "app/files/file_io.h"
#include "app/options/output_kind.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

std::string shown(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string difference_of_options(const json& before, const json& now) {
    for (const auto& [name, value] : now.items()) {
        if (!before.contains(name)) return fmt::format("{} was not given and is {}", name, shown(value));
        if (before[name] != value) return fmt::format("{} was {} and is {}", name, shown(before[name]), shown(value));
    }
    for (const auto& [name, value] : before.items())
        if (!now.contains(name)) return fmt::format("{} was {} and is not given", name, shown(value));
    return {};
}

std::string difference_of_inputs(const json& before, const json& now) {
    for (std::size_t i = 0; i < std::max(before.size(), now.size()); ++i) {
        if (i >= now.size()) return fmt::format("the input {} is gone", shown(before[i].value("file", json())));
        const std::string file = shown(now[i].value("file", json()));
        if (i >= before.size()) return fmt::format("the input {} is new", file);
        if (before[i].value("checksum", json()) != now[i].value("checksum", json()))
            return fmt::format("the input {} has changed", file);
    }
    return {};
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

std::string why_not_opened(int failure) {
    return failure == ELOOP ? "it is a link, which is not followed" : std::strerror(failure);
}

constexpr const char *lock_name = "lock", *manifest_name = "manifest.json";

/// A file's state: another size or time is another file.
json leftover_of(const std::filesystem::path& file) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (error) return nullptr;
    const auto written = std::filesystem::last_write_time(file, error).time_since_epoch().count();
    if (error) return nullptr;
    return {{"file", file.filename().string()}, {"bytes", bytes}, {"written", static_cast<std::int64_t>(written)}};
}

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::vector<std::filesystem::path> entries;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) entries.push_back(entry.path());
    return entries;
}

/// Whether a work folder holds only a lock, or an unfinished first manifest.
bool holds_nothing(const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> entries = entries_of(folder);
    return std::all_of(entries.begin(), entries.end(), [](const std::filesystem::path& entry) {
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

std::string name_of(const Chunk& chunk) {
    return fmt::format("chunk_{:05}.m2v", chunk.index);
}

/// Refuses another film's folder; without a manifest it holds nothing. A damaged manifest may still have good chunks.
void refuse_other(const std::filesystem::path& output, const json& identity) {
    const std::filesystem::path folder = work_folder_of(output);
    const json earlier = manifest_in(folder);
    std::error_code ignored;
    if (earlier.empty() && !std::filesystem::exists(folder / manifest_name, ignored)) return;
    const std::string difference = earlier.empty() ? manifest_name + std::string(" is damaged in ") + folder.string()
                                                   : difference_of(earlier.value("identity", json()), identity);
    if (!difference.empty())
        throw core::Error("resuming", output.string(), difference + "; without --resume the film begins anew");
}

}  // namespace

std::string difference_of(const json& before, const json& now) {
    if (before == now) return {};
    if (!before.is_object()) return "what was left is of no known version";
    for (const char* name : {"version", "isa"})
        if (before.value(name, json()) != now.value(name, json()))
            return fmt::format("the {} was {} and is {}",
                               std::string_view(name) == "isa" ? "instruction set" : "version of render2mpeg",
                               shown(before.value(name, json())), shown(now.value(name, json())));
    if (before.value("build", json()) != now.value("build", json())) return "render2mpeg was built anew since";
    const auto part = [](const json& of, const char* name, const json& otherwise) {
        return of.contains(name) && of[name].type() == otherwise.type() ? of[name] : otherwise;
    };
    std::string text =
        difference_of_options(part(before, "options", json::object()), part(now, "options", json::object()));
    if (text.empty())
        text = difference_of_inputs(part(before, "inputs", json::array()), part(now, "inputs", json::array()));
    if (text.empty() && before.value("frames", json()) != now.value("frames", json()))
        text = fmt::format("the frames were {} and are {}", shown(before.value("frames", json())),
                           shown(now.value("frames", json())));
    return text.empty() ? "it is another film" : text;
}

OutputLock::OutputLock(const std::filesystem::path& file, const std::filesystem::path& output) {
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
        if (failure == 0 && is_current(descriptor_, file)) break;
        close(descriptor_);
        descriptor_ = -1;
        if (left > 0 && (failure == 0 || failure == EWOULDBLOCK)) continue;
        if (failure == 0 || failure == EWOULDBLOCK) refuse(file, output);
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

WorkFolder::WorkFolder(const std::filesystem::path& output, const json& identity, Earlier earlier)
    : output_(output),
      folder_((check(output), work_folder_of(output))),
      lock_(folder_ / lock_name, output),
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
    const bool same = difference_of(before.value("identity", json()), (*manifest_)["identity"]).empty();
    resumed_ = same && earlier == Earlier::resumed;
    const json leftovers = before.value("leftovers", json::array()), settled = before.value("kept", json::object());
    (*manifest_)["leftovers"] = same && leftovers.is_array() ? leftovers : json::array();
    // Leftovers of other films under this name go when this one leaves a part.
    json others = before.value("others", json::array());
    if (!others.is_array()) others = json::array();
    if (!same && leftovers.is_array()) others.insert(others.end(), leftovers.begin(), leftovers.end());
    (*manifest_)["others"] = others;
    const json companions = before.value("companions", json::array());
    (*manifest_)["companions"] = companions.is_array() ? companions : json::array();
    (*manifest_)["kept"] = resumed_ && settled.is_object() ? settled : json::object();
    begun_ = resumed_;
    if (!resumed_) drop_all_but({});
    write_manifest();
}

WorkFolder::~WorkFolder() {
    for (const char* name : {"leftovers", "others"})
        if (manifest_->contains(name) && !(*manifest_)[name].empty()) return;
    if (begun_ || removed_) return;
    remove_companions();
    remove();
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
    std::error_code error;
    const bool ours =
        S_ISDIR(there.st_mode) && (holds_nothing(folder) || std::filesystem::exists(folder / manifest_name, error));
    if (!ours)
        throw core::Error("writing", folder.string(),
                          "something of that name is in the way that is no unfinished film");
}

void WorkFolder::check(const std::filesystem::path& output, const json& identity) {
    check(output);
    refuse_other(output, as_written(identity));
}

std::size_t WorkFolder::left(const std::filesystem::path& output, const json& identity,
                             const std::vector<Chunk>& chunks) {
    const std::filesystem::path folder = work_folder_of(output);
    if (!difference_of(manifest_in(folder).value("identity", json()), as_written(identity)).empty()) return 0;
    std::size_t count = 0;
    std::error_code error;
    while (count < chunks.size() &&
           std::filesystem::exists(ChunkFile::record_of(folder / name_of(chunks[count])), error))
        ++count;
    return count;
}

bool WorkFolder::is_of(const std::filesystem::path& output, const json& identity) {
    const json manifest = manifest_in(work_folder_of(output));
    return !manifest.empty() && difference_of(manifest.value("identity", json()), as_written(identity)).empty();
}

std::filesystem::path WorkFolder::file_of(const Chunk& chunk) const {
    return place(name_of(chunk));
}

std::vector<ChunkFile> WorkFolder::finished(const std::vector<Chunk>& chunks) const {
    std::vector<ChunkFile> files;
    for (const Chunk& chunk : chunks) {
        std::optional<ChunkFile> file = resumed_ ? ChunkFile::reopened(file_of(chunk), chunk) : std::nullopt;
        if (!file) break;
        files.push_back(std::move(*file));
    }
    return files;
}

void WorkFolder::drop_all_but(const std::vector<ChunkFile>& chunks) {
    for (const std::filesystem::path& entry : entries_of(folder_)) {
        const bool own = entry.filename() == lock_name || entry.filename() == manifest_name;
        const bool wanted = std::any_of(chunks.begin(), chunks.end(), [&](const ChunkFile& chunk) {
            return entry.stem() == chunk.file().stem();  // stream, record, frames
        });
        if (!own && !wanted) std::filesystem::remove_all(entry);
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

void WorkFolder::remember_companion(const std::filesystem::path& output, const json& identity) {
    std::error_code error;
    const std::filesystem::path name = std::filesystem::absolute(output, error).lexically_normal();
    const json one = as_written({{"file", name.string()}, {"identity", identity}});
    json& companions = (*manifest_)["companions"];
    if (std::find(companions.begin(), companions.end(), one) != companions.end()) return;
    companions.push_back(one);
    write_manifest();
}

std::vector<std::filesystem::path> WorkFolder::companions() const {
    std::vector<std::filesystem::path> files;
    for (const json& one : manifest_->value("companions", json::array()))
        if (one.is_object() && one.value("file", json()).is_string())
            files.emplace_back(one["file"].get<std::string>());
    return files;
}

void WorkFolder::remove_companions() const {
    for (const json& one : manifest_->value("companions", json::array())) {
        if (!one.is_object() || !one.value("file", json()).is_string()) continue;
        const std::filesystem::path file(one["file"].get<std::string>());
        // Only this film's folders, or empty ones (of killed runs); this run's are locked.
        const std::filesystem::path folder = work_folder_of(file);
        std::error_code error;
        const bool same = one.value("identity", json()) == manifest_in(folder).value("identity", json(false));
        if (!same && !(std::filesystem::is_directory(folder, error) && holds_nothing(folder))) continue;
        try {
            check(file);
            WorkFolder(file, one["identity"]).remove();
        } catch (const std::exception&) {
            // In use, or not removable: harmless.
        }
    }
}

ChunkFile WorkFolder::open(const Chunk& chunk) {
    begun_ = true;
    return {file_of(chunk), chunk};
}

std::filesystem::path WorkFolder::leave(const std::filesystem::path& file) {
    // The new leftover replaces earlier ones.
    for (const char* name : {"leftovers", "others"}) {
        remove_all_of((*manifest_)[name]);
        (*manifest_)[name] = json::array();
    }
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

void WorkFolder::remove_all_of(const json& leftovers) const {
    const std::filesystem::path folder = output_.parent_path();
    for (const json& leftover : leftovers) {
        if (!leftover.is_object() || !leftover.contains("file") || !leftover["file"].is_string()) continue;
        const std::filesystem::path name = std::filesystem::path(leftover["file"].get<std::string>()).filename();
        std::error_code ignored;
        if (leftover == leftover_of(folder / name)) std::filesystem::remove(folder / name, ignored);
    }
}

void WorkFolder::clear_away() {
    remove_all_of((*manifest_)["leftovers"]);
    remove_companions();
    remove();
}

void WorkFolder::remove() {
    if (removed_) return;  // the present folder is the next run's
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
