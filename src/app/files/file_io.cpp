#include "app/files/file_io.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <vector>

#include "app/files/output_stream.h"
#include "core/error.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// Returns 0, or errno.
int write_and_close(std::FILE* stream, const std::string& text) {
    errno = 0;
    const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    int failure = written ? 0 : errno;
    // A name must not outlive its content when the power fails.
    if (std::fflush(stream) != 0) {
        if (failure == 0) failure = errno;
    } else if (fsync(fileno(stream)) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT) && failure == 0) {
        failure = errno;
    }
    if (std::fclose(stream) != 0 && failure == 0) failure = errno;
    return failure;
}

constexpr const char* temporary_mark = ".render2mpeg-";

/// Removes temporary files of killed processes: this beginning, and a number that is no process any more.
void remove_abandoned(const std::filesystem::path& start) {
    const std::filesystem::path folder = start.has_parent_path() ? start.parent_path() : ".";
    const std::string name = start.filename().string();
    std::error_code error;
    std::vector<std::filesystem::path> abandoned;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string found = entry->path().filename().string();
        if (!found.starts_with(name) || !found.ends_with(".tmp")) continue;
        const char* const last = found.data() + found.size();
        pid_t process = 0;
        const auto [stop, failure] = std::from_chars(found.data() + name.size(), last, process);
        if (failure != std::errc() || stop == last || *stop != '-' || process <= 0) continue;
        if (kill(process, 0) != 0 && errno == ESRCH) abandoned.push_back(entry->path());
    }
    for (const std::filesystem::path& file : abandoned) std::filesystem::remove(file, error);
}

[[noreturn]] void fail(const std::filesystem::path& file, int failure) {
    throw core::Error("writing", file.string(), failure != 0 ? std::strerror(failure) : "the file cannot be written");
}

void bring(const std::filesystem::path& place, int flags) {
    const int descriptor = open(place.c_str(), O_RDONLY | O_CLOEXEC | flags);
    if (descriptor < 0) return;
    const bool lost = fsync(descriptor) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT);
    const int failure = errno;
    close(descriptor);
    if (lost) throw core::Error("writing", place.string(), std::strerror(failure));
}

}  // namespace

void write_whole(const std::filesystem::path& file, const std::string& text) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        std::istringstream from(text);
        write_into(file, from);
        return;
    }

    // A link stays; its target is replaced.
    std::filesystem::path target = file;
    if (std::filesystem::is_symlink(file, error) && std::filesystem::exists(status))
        target = std::filesystem::canonical(file, error);

    // Write it beside, under a name that nobody has.
    const std::string start = target.string() + temporary_mark;
    remove_abandoned(start);
    std::filesystem::path temporary;
    std::FILE* stream = nullptr;
    for (int i = 0; stream == nullptr; ++i) {
        temporary = start + std::to_string(getpid()) + "-" + std::to_string(i) + ".tmp";
        stream = std::fopen(temporary.c_str(), "wbx");
        if (stream == nullptr && errno != EEXIST) fail(file, errno);
    }
    int failure = write_and_close(stream, text);
    if (failure == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
    if (failure == 0) return;
    std::filesystem::remove(temporary, error);
    fail(file, failure);
}

std::string file_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(stream), {});
    if (!stream) throw core::Error("reading", file.string(), "it cannot be read");
    return text;
}

std::string json_text(const nlohmann::json& value) {
    return value.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

nlohmann::json parsed_json(std::string_view text) {
    using nlohmann::json;
    // Values are copied, compared and written by functions that call themselves.
    constexpr int deepest = 32;
    bool too_deep = false;
    json value = json::parse(
        text,
        [&](int depth, json::parse_event_t, json&) {
            too_deep = too_deep || depth >= deepest;
            return !too_deep;
        },
        false);
    return too_deep ? json(json::value_t::discarded) : value;
}

nlohmann::json read_json(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return parsed_json(std::string(std::istreambuf_iterator<char>(stream), {}));
}

void write_json(const std::filesystem::path& file, const nlohmann::json& value) {
    write_whole(file, json_text(value));
}

nlohmann::json finite_or_null(std::optional<double> value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json text_or_null(const std::string& text) {
    return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

void print(const std::string& text) {
    const std::string shown = core::printable_lines(text);
    errno = 0;
    if (std::fwrite(shown.data(), 1, shown.size(), stdout) != shown.size() || std::fflush(stdout) != 0)
        fail("standard output", errno);
}

void bring_to_disk(const std::filesystem::path& file) {
    bring(file, 0);
}

void bring_name_to_disk(const std::filesystem::path& file) {
    bring(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."), O_DIRECTORY);
}

bool is_there(const std::filesystem::path& name) {
    std::error_code error;
    return std::filesystem::exists(name, error);
}

bool is_file(const std::filesystem::path& name) {
    std::error_code error;
    return std::filesystem::is_regular_file(name, error);
}

std::filesystem::path canonical_of(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error);
}

std::uint64_t checksum_of(const core::Picture& picture) {
    Checksum sum;
    for (const core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr}) sum.add(plane->values());
    return sum.value();
}

std::string program_text() {
    const std::filesystem::path program("/proc/self/exe");
    return std::string(RENDER2MPEG_VERSION) + " (build " +
           (is_there(program) ? text_of(checksum_of(program)) : "unknown") + ")";
}

std::string text_of(std::uint64_t checksum) {
    return core::checksum_text(checksum);
}

}  // namespace render2mpeg::app
