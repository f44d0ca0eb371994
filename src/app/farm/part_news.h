#pragma once
// What a part that is being made tells of itself, for those who ask how far the film is.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// chosen: often enough to tell who is alive, and seldom enough for a thousand parts on one file system.
inline constexpr std::chrono::seconds news_pause(30);

enum class PartState { running, done, failed, interrupted };

/// Contents and age of the status file.
struct PartNews {
    PartState state = PartState::running;
    std::int64_t done = 0, total = 0;  ///< frames
    double seconds = 0;                ///< on the clock, of the try that said so
    std::string machine;
    std::string error;  ///< why it failed
    double age = 0;     ///< seconds since it was written

    /// Whether a part reported as running has stopped reporting: it was killed, or its machine is gone.
    bool is_lost() const {
        // chosen: four times the pause: a busy file server delays what others see.
        return state == PartState::running && age > 4.0 * static_cast<double>(news_pause.count());
    }
};

/// The last news of the part whose folder this is; none where there is no file that can be read.
std::optional<PartNews> news_in(const std::filesystem::path& folder);

/// Writes the news of a part that is being made, now and every half minute. That one cannot be written is no failure.
class PartReporter {
  public:
    /// `total` frames.
    PartReporter(std::filesystem::path folder, std::int64_t total);

    /// So many frames are done.
    void advance_to(std::int64_t done);
    /// How it ended. `error`: why it failed.
    void end(PartState state, const std::string& error = {});

  private:
    void write();

    std::filesystem::path folder_;
    PartNews news_;
    double start_ = clock_seconds();
    std::mutex mutex_;
    std::jthread ticker_;  ///< last, so that it ends first
};

}  // namespace render2mpeg::app
