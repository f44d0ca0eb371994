#pragma once
// The progress line.
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace render2mpeg::app {

/// Time to go: frames that begin light anew as all of these so far, others as the last few of them.
class Pace {
  public:
    /// `firsts`: frames that begin light anew, ascending: those of chunks, and after cuts. `prices`: of each frame
    /// beside others, > 0; empty: all cost alike.
    explicit Pace(std::vector<std::int64_t> firsts = {}, const std::vector<double>& prices = {});

    void add(double seconds);
    /// Frames done before.
    void skip(std::int64_t frames) { done_ += frames; }

    /// Seconds up to frame `total`, of which the present one took `spent`; > 0 while any are left. None where nothing
    /// is known.
    std::optional<double> left(std::int64_t total, double spent = 0) const;
    /// Of later frames; 0: unknown.
    double per_second() const;

  private:
    bool is_first(std::int64_t frame) const;
    /// Prices of the frames from `frame` on below `total`, those of firsts or of others.
    double prices(std::int64_t frame, std::int64_t total, bool of_firsts) const;
    /// Mean of recent later frames, over their prices; 0: unknown.
    double later() const;

    std::vector<std::int64_t> firsts_;
    std::vector<double> sums_[2];  ///< of prices up to each frame, of others and of firsts; empty: each is 1
    std::int64_t done_ = 0;
    double first_seconds_ = 0;
    int first_count_ = 0;
    std::deque<double> recent_;
};

struct Standing {
    std::string work = "frame";  ///< unit of `done` and `total`
    std::int64_t done = 0, total = 0;
    double per_second = 0;       ///< 0: not known yet
    double seconds = 0;          ///< since the beginning
    bool frames = true;          ///< they are counted: their rate is told
    std::optional<double> left;  ///< seconds to go; none: not known
    std::string activity{};      ///< current step of the current frame; empty: not shown
};

/// One line of at most `columns` >= 20 characters: times, then bar, counts and rate as they fit.
std::string progress_line(const Standing& standing, int columns, bool with_bar);

/// A JSON object on one line: `work`, `done`, `total`, `seconds`, `left`, `whole` (or null), `activity`.
std::string progress_json(const Standing& standing);

/// Progress as a line, a line a minute, JSON, or OpenJD's [OpenJD, How Jobs Are Run].
enum class ProgressStyle { line, minute, json, openjd, none };
ProgressStyle progress_style_from(const std::string& name);
void show_progress_as(ProgressStyle style);

/// Activity on all lines from now on.
void tell_activity(std::string words);

/// Calls `tick` after each pause, until it is destroyed.
[[nodiscard]] std::jthread every(std::chrono::seconds pause, std::function<void()> tick);

/// Tells activities on standard error until a line of Progress moves, on terminals from the first second on, in logs
/// from the tenth: each change, and once a minute while one lasts.
[[nodiscard]] std::jthread tell_activities(bool quiet);

/// Whether steps have lines too: logs have results alone.
bool shows_steps();
/// Whether progress is told in words, for people and logs.
bool shows_words();

/// Frames of the film, frames of a step, or its parts; lines of steps vanish in the end.
enum class Counted { frames, frames_of_step, parts_of_step };

/// Progress on standard error: a rewritten line on terminals, lines every ten per cent or minute, or JSON.
class Progress {
  public:
    /// `total` of `work`, which began `seconds_ago`. `pace` knows of frames that cost more than others.
    Progress(std::int64_t total, bool quiet, const std::string& work = "frame", Counted counted = Counted::frames,
             double seconds_ago = 0, Pace pace = Pace());
    ~Progress();

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
    std::jthread ticker_;
};

/// Counts one more, and tells whether nobody interrupted.
std::function<bool()> advancing(Progress& progress);

/// "1:02:03", "2:03": hours only where there are any.
std::string clock_text(double seconds);

}  // namespace render2mpeg::app
