#include "app/files/text_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Writes all of it and closes the stream. Returns 0, or what went wrong as in errno.
int write_and_close(std::FILE* stream, const std::string& text) {
    errno = 0;
    const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    int failure = written ? 0 : errno;
    // A name must not outlive what it is for when the power fails.
    if (std::fflush(stream) != 0) {
        if (failure == 0) failure = errno;
    } else if (fsync(fileno(stream)) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT) && failure == 0) {
        failure = errno;
    }
    if (std::fclose(stream) != 0 && failure == 0) failure = errno;
    return failure;
}

[[noreturn]] void fail(const std::filesystem::path& file, int failure) {
    throw core::Error("writing", file.string(), failure != 0 ? std::strerror(failure) : "the file cannot be written");
}

}  // namespace

void write_whole(const std::filesystem::path& file, const std::string& text) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        std::FILE* stream = std::fopen(file.c_str(), "wb");
        const int failure = stream == nullptr ? errno : write_and_close(stream, text);
        if (stream == nullptr || failure != 0) fail(file, failure);
        return;
    }

    // A link stays one; what it leads to is replaced.
    std::filesystem::path target = file;
    if (std::filesystem::is_symlink(file, error) && std::filesystem::exists(status))
        target = std::filesystem::canonical(file, error);

    // Write it beside, under a name that nobody has.
    std::filesystem::path temporary;
    std::FILE* stream = nullptr;
    for (int i = 0; stream == nullptr; ++i) {
        temporary = target.string() + "." + std::to_string(getpid()) + "-" + std::to_string(i) + ".tmp";
        stream = std::fopen(temporary.c_str(), "wbx");
        if (stream == nullptr && errno != EEXIST) fail(file, errno);
    }
    int failure = write_and_close(stream, text);
    if (failure == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
    if (failure == 0) return;
    std::filesystem::remove(temporary, error);
    fail(file, failure);
}

std::string json_text(const nlohmann::json& value) {
    return value.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string as_json_keeps(const std::string& name) {
    return nlohmann::json::parse(json_text(name)).get<std::string>();
}

void print(const std::string& text) {
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        fail("standard output", errno);
}

}  // namespace render2mpeg::app
