#pragma once
// Files that another program may be writing.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

namespace render2mpeg::app {

/// Tells when files have changed, by size and time, and when changes have settled. Replaced and missing files have
/// changed.
class WatchedFiles {
  public:
    /// Empty names are skipped; of folders their direct files count.
    explicit WatchedFiles(std::vector<std::filesystem::path> files);

    /// Looks at most five times a second.
    bool have_changed();
    void note_change() { changed_ = true; }
    /// Waits for a change and `settled` time without one; missing files are waited for. False where `goes_on`, asked
    /// ten times a second, says no.
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
