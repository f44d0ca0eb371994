#include "app/files/watched_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

namespace render2mpeg::app {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

WatchedFiles::WatchedFiles(std::vector<std::filesystem::path> files)
    : files_(std::move(files)), before_(look()), looked_(Clock::now()) {}

WatchedFiles::States WatchedFiles::look() const {
    States states;
    const auto add = [&](const std::filesystem::path& file) {
        struct stat found {};
        State state;
        if (stat(file.c_str(), &found) == 0)
            state = {found.st_mtim.tv_sec, found.st_mtim.tv_nsec, static_cast<std::uint64_t>(found.st_size),
                     found.st_ino, true};
        states[file] = state;
    };
    for (const std::filesystem::path& file : files_) {
        if (file.empty()) continue;
        std::error_code error;
        if (!std::filesystem::is_directory(file, error)) {
            add(file);
            continue;
        }
        for (const auto& entry : std::filesystem::directory_iterator(file, error))
            if (entry.is_regular_file(error)) add(entry.path());
    }
    return states;
}

bool WatchedFiles::have_changed() {
    // chosen: 200 ms; a look at a thousand files takes one or two.
    if (changed_ || Clock::now() - looked_ < std::chrono::milliseconds(200)) return changed_;
    looked_ = Clock::now();
    changed_ = look() != before_;
    return changed_;
}

bool WatchedFiles::wait(std::chrono::milliseconds settled, const std::function<bool()>& goes_on) {
    constexpr std::chrono::milliseconds beat{100};
    while (!have_changed()) {
        if (!goes_on()) return false;
        std::this_thread::sleep_for(beat);
    }
    States last = look();
    for (Clock::time_point since = Clock::now(); Clock::now() - since < settled;) {
        if (!goes_on()) return false;
        std::this_thread::sleep_for(beat);
        States now = look();
        const bool missing = std::any_of(now.begin(), now.end(), [&](const auto& entry) {
            const auto found = before_.find(entry.first);
            return !entry.second.there && found != before_.end() && found->second.there;
        });
        if (now != last || missing) since = Clock::now();
        last = std::move(now);
    }
    return true;
}

}  // namespace render2mpeg::app
