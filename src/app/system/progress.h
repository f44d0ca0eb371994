#pragma once
// The progress line.
#include <chrono>
#include <cstdint>
#include <string>

namespace render2mpeg::app {

/// How far a run is.
struct Standing {
    std::string work = "frame";  ///< what is counted
    std::int64_t done = 0, total = 0;
    double per_second = 0;  ///< 0: not known yet
    double seconds = 0;     ///< since the beginning
    bool frames = true;     ///< they are counted: their rate is told
};

/// One line about it, at most `columns` characters (at least 20): what fits of a bar, counts, rate and time to go.
std::string progress_line(const Standing& standing, int columns, bool with_bar);

/// What is counted: frames, whose line stays; frames of a step on the way, or parts of one: a terminal's line goes with
/// the object.
enum class Counted { frames, frames_of_step, parts_of_step };

/// How far a render is, on standard error: a bar that rewrites its line on a terminal, else a plain line every ten per
/// cent.
class Progress {
  public:
    /// `total` frames or parts. Silent when `quiet`. `work` names what is counted; it began `seconds_ago`.
    Progress(std::int64_t total, bool quiet, const std::string& work = "frame", Counted counted = Counted::frames,
             double seconds_ago = 0);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// One more is finished.
    void advance();
    /// `done` are finished, of what is now known to be `total`.
    void advance_to(std::int64_t done, std::int64_t total);

  private:
    void draw();

    using Clock = std::chrono::steady_clock;
    Standing standing_;
    bool quiet_, terminal_, stays_;
    bool drawn_ = false;
    std::int64_t next_plain_ = 0;
    Clock::time_point start_, drawn_at_;
};

/// "1:02:03", "2:03": hours only where there are any.
std::string clock_text(double seconds);

}  // namespace render2mpeg::app
