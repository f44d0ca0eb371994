#pragma once
// Status of a part during its rendering, in a small file for other processes.
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace render2mpeg::app {

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
    bool is_lost() const;
};

/// The last news of the part whose folder this is; none where there is no file that can be read.
std::optional<PartNews> news_in(const std::filesystem::path& folder);

/// Writes the news of a part that is being made, now and every half minute. That one cannot be written is no failure.
class PartReporter {
  public:
    /// `total` frames.
    PartReporter(std::filesystem::path folder, std::int64_t total);
    ~PartReporter();
    PartReporter(const PartReporter&) = delete;
    PartReporter& operator=(const PartReporter&) = delete;

    /// So many frames are done.
    void advance_to(std::int64_t done);
    /// How it ended. `error`: why it failed.
    void end(PartState state, const std::string& error = {});

  private:
    void write();

    std::filesystem::path folder_;
    PartNews news_;
    std::chrono::steady_clock::time_point start_;
    std::mutex mutex_;
    std::condition_variable ends_;
    bool ended_ = false;
    std::thread ticker_;
};

}  // namespace render2mpeg::app
