#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace render2mpeg::app {

/// How far a render is, on standard error: a bar that rewrites its line on a terminal, else a plain line every ten per
/// cent.
class Progress {
  public:
    /// `total` frames, of which `done` need no work. Silent when `quiet`.
    Progress(std::int64_t total, std::int64_t done, bool quiet);
    ~Progress();

    /// One more frame is finished.
    void advance();
    /// A line for the user that must not be overwritten by the bar.
    void say(const std::string& line);

  private:
    void draw(bool last);

    using Clock = std::chrono::steady_clock;
    std::int64_t total_, done_, skipped_;
    bool quiet_, terminal_;
    bool drawn_ = false;
    std::int64_t next_plain_ = 0;
    Clock::time_point start_, drawn_at_;
};

/// "1:02:03", "2:03": hours only where there are any.
std::string clock_text(double seconds);

}  // namespace render2mpeg::app
