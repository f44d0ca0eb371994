#pragma once
// The progress line.
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/system/pace.h"

namespace render2mpeg::app {

struct Standing {
    std::string work = "frame";  ///< unit of `done` and `total`
    std::int64_t done = 0, total = 0;
    double per_second = 0;       ///< 0: not known yet
    double seconds = 0;          ///< since the beginning
    bool frames = true;          ///< they are counted: their rate is told
    std::optional<double> left;  ///< seconds to go; none: not known
    const char* activity = "";   ///< current step of the current frame; empty: not shown
};

/// One line of at most `columns` >= 20 characters: times, then bar, counts and rate as they fit.
std::string progress_line(const Standing& standing, int columns, bool with_bar);

/// A JSON object on one line: `work`, `done`, `total`, `seconds`, `left`, `whole` (or null), `activity`.
std::string progress_json(const Standing& standing);

/// Progress as a line, a line a minute, JSON, or OpenJD's [OpenJD, How Jobs Are Run].
enum class ProgressStyle { line, minute, json, openjd, none };
ProgressStyle progress_style_from(const std::string& name);
void show_progress_as(ProgressStyle style);

/// Activity on all lines from now on; a literal.
void tell_activity(const char* words);

/// Whether steps have lines too: logs have results alone.
bool shows_steps();

/// Frames of the film, frames of a step, or its parts; lines of steps vanish in the end.
enum class Counted { frames, frames_of_step, parts_of_step };

/// Progress on standard error: a rewritten line on terminals, lines every ten per cent or minute, or JSON.
class Progress {
  public:
    /// `total` of `work`, which began `seconds_ago`. `firsts`: as in Pace.
    Progress(std::int64_t total, bool quiet, const std::string& work = "frame", Counted counted = Counted::frames,
             double seconds_ago = 0, std::vector<std::int64_t> firsts = {});
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance();
    /// The total may change.
    void advance_to(std::int64_t done, std::int64_t total);

  private:
    using Clock = std::chrono::steady_clock;
    void draw();
    void draw_openjd() const;
    void reckon(Clock::time_point now);
    void tick();

    Standing standing_;
    Pace pace_;
    bool quiet_, terminal_, stays_, json_, timed_;
    bool drawn_ = false;
    std::int64_t next_plain_ = 0;
    double before_;  ///< seconds that it took before the object
    Clock::time_point start_, drawn_at_, advanced_at_;
    std::mutex mutex_;
    std::condition_variable ends_;
    bool ended_ = false;
    std::thread ticker_;
};

/// "1:02:03", "2:03": hours only where there are any.
std::string clock_text(double seconds);

}  // namespace render2mpeg::app
