#pragma once
// Files that another program may be writing.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

namespace render2mpeg::app {

/// Tells when files have changed, and when whoever changes them has finished. Looks at their sizes and times; a file
/// that is replaced, or missing for a while, has changed.
class WatchedFiles {
  public:
    /// As they are now. Empty names are passed over; of folders the files directly in them count.
    explicit WatchedFiles(std::vector<std::filesystem::path> files);

    /// Whether any is not as it was. Looks no more than five times a second.
    bool have_changed();
    /// Something has changed that was seen elsewhere.
    void note_change() { changed_ = true; }
    /// Waits for a change and, after it, until nothing changes any more for `settled`; what is missing then is waited
    /// for as well. False where `goes_on`, asked ten times a second, says no.
    bool wait(std::chrono::milliseconds settled, const std::function<bool()>& goes_on);

  private:
    struct State {
        std::int64_t seconds = 0, nanoseconds = 0;
        std::uint64_t size = 0, inode = 0;
        bool there = false;
        bool operator==(const State&) const = default;
    };
    using States = std::map<std::filesystem::path, State>;
    States look() const;

    std::vector<std::filesystem::path> files_;
    States before_;
    std::chrono::steady_clock::time_point looked_;
    bool changed_ = false;
};

}  // namespace render2mpeg::app
