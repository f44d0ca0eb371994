#include "app/files/disk.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

void bring(const std::filesystem::path& place, int flags) {
    const int descriptor = open(place.c_str(), O_RDONLY | O_CLOEXEC | flags);
    if (descriptor < 0) return;
    const bool lost = fsync(descriptor) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT);
    const int failure = errno;
    close(descriptor);
    if (lost) throw core::Error("writing", place.string(), std::strerror(failure));
}

}  // namespace

void bring_to_disk(const std::filesystem::path& file) {
    bring(file, 0);
}

void bring_name_to_disk(const std::filesystem::path& file) {
    bring(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."), O_DIRECTORY);
}

std::filesystem::path canonical_of(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error);
}

}  // namespace render2mpeg::app
