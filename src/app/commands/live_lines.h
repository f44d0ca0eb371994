#pragma once
// What a live view is asked for: lines of JSON (docs/pictures.md).
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "app/loop/live_view.h"
#include "app/options/options.h"

namespace render2mpeg::app {

struct LiveLine {
    std::string text;
    std::uint64_t number = 0;  ///< from 1
    std::chrono::steady_clock::time_point came;
};

/// Reads lines from a descriptor in a thread.
class LiveLines {
  public:
    explicit LiveLines(int descriptor);
    ~LiveLines();
    LiveLines(const LiveLines&) = delete;
    LiveLines& operator=(const LiveLines&) = delete;

    /// Whether a line, or the end, is there.
    bool any() const { return any_ || ended_; }
    /// All lines that are there.
    std::vector<LiveLine> take();
    /// Whether no line will come any more.
    bool has_ended() const { return ended_; }

  private:
    void read(const std::stop_token& stop);
    void add(const char* bytes, std::size_t count);

    int descriptor_;
    std::string rest_;  ///< a line's beginning
    std::mutex mutex_;
    std::vector<LiveLine> lines_;
    std::uint64_t count_ = 0;
    std::atomic<bool> any_{false}, ended_{false};
    std::jthread reader_;
};

/// What one line asks for; what it does not name stays.
struct LiveCommand {
    std::optional<std::filesystem::path> scene;
    std::optional<std::optional<scene::Viewpoint>> camera;  ///< within: none is the film's own
    std::optional<Size> size;
    std::optional<std::int64_t> frame;
    bool quit = false;
};

/// Throws core::Error: what is wrong with the line.
LiveCommand live_command_from(const std::string& line);

}  // namespace render2mpeg::app
