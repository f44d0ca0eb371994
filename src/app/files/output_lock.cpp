#include "app/files/output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::filesystem::path& output) {
    std::string process;
    std::ifstream(file) >> process;
    throw OutputInUse("writing", output.string(),
                      "another run is writing it" + (process.empty() ? "" : " (process " + process + ")"));
}

/// Whether the name still is that of the file that is open: the run that held it may have removed it since.
bool is_current(int descriptor, const std::filesystem::path& file) {
    struct stat opened {
    }, named{};
    return fstat(descriptor, &opened) == 0 && lstat(file.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

/// Whether a file has this name alone, and is no pipe or the like: what is written to it changes nothing else.
bool is_plain(int descriptor) {
    struct stat opened {};
    return fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) && opened.st_nlink <= 1;
}

std::string why_not_opened(int failure) {
    return failure == ELOOP ? "it is a link, which is not followed" : std::strerror(failure);
}

}  // namespace

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
    // Say who holds it; a lock that does not say so is one all the same.
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

}  // namespace render2mpeg::app
