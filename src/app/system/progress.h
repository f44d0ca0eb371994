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

namespace render2mpeg::app {

/// Reckons the time to go from recent frames. The first frame of a chunk takes more than others: it makes what later
/// ones use, so that it counts apart.
class Pace {
  public:
    /// `chunk`: frames of a chunk; 0: all are alike. `takes_turns`: the second frame of a chunk is a B picture.
    explicit Pace(std::int64_t chunk = 0, bool takes_turns = false) : chunk_(chunk), takes_turns_(takes_turns) {}

    /// The next frame took so many seconds.
    void add(double seconds);
    /// So many frames were done before, in a time that tells nothing.
    void skip(std::int64_t frames) { done_ += frames; }

    /// Seconds for the frames up to `total`, of which the frame at hand has taken `spent` already; above 0 as long as
    /// there are any. None where nothing is known at all.
    std::optional<double> left(std::int64_t total, double spent = 0) const;
    /// Frames per second, of those that are no chunk's first; 0: not known.
    double per_second() const;

  private:
    bool is_first(std::int64_t frame) const { return chunk_ > 0 && frame % chunk_ == 0; }
    /// The mean of the recent ones that are no chunk's first; 0: none is known.
    double recent() const;

    std::int64_t chunk_, done_ = 0;
    bool takes_turns_;
    std::vector<double> later_;
    double firsts_ = 0;  ///< seconds of chunks' first frames
    int first_count_ = 0;
};

/// How far a run is.
struct Standing {
    std::string work = "frame";  ///< what is counted
    std::int64_t done = 0, total = 0;
    double per_second = 0;       ///< 0: not known yet
    double seconds = 0;          ///< since the beginning
    bool frames = true;          ///< they are counted: their rate is told
    std::optional<double> left;  ///< seconds to go; none: not known
    const char* activity = "";   ///< what is being done to the frame at hand; empty: nothing is told
};

/// One line about it, at most `columns` characters (at least 20): the time of the whole run and to go, then what fits
/// of a bar, counts and rate.
std::string progress_line(const Standing& standing, int columns, bool with_bar);

/// The same as a JSON object on one line: `work`, `done`, `total`, `seconds`, `left` and `whole` or null, and
/// `activity`.
std::string progress_json(const Standing& standing);

/// How runs of this process tell how far they are: as a line for people, a line a minute for logs, as JSON for
/// programs, or on standard output as OpenJD reads it [OpenJD, How Jobs Are Run].
enum class ProgressStyle { line, minute, json, openjd, none };
/// The style of that name, as --progress has it.
ProgressStyle progress_style_from(const std::string& name);
void show_progress_as(ProgressStyle style);

/// What is being done to the frame at hand, for all lines from now on. `words` live as long as the program.
void tell_activity(const char* words);

/// Whether steps on the way are told, too: a log has their results alone.
bool shows_steps();

/// What is counted: frames, whose line stays; frames of a step on the way, or parts of one: a terminal's line goes with
/// the object.
enum class Counted { frames, frames_of_step, parts_of_step };

/// How far a render is, on standard error: a bar that rewrites its line on a terminal, every second also where nothing
/// is finished; else a plain line every ten per cent, or every minute; or JSON, a line for every part and every second.
class Progress {
  public:
    /// `total` frames or parts. Silent when `quiet`. `work` names what is counted; it began `seconds_ago`. `chunk`:
    /// frames of a chunk, whose first takes longer; 0: all are alike. `takes_turns`: see Pace.
    Progress(std::int64_t total, bool quiet, const std::string& work = "frame", Counted counted = Counted::frames,
             double seconds_ago = 0, std::int64_t chunk = 0, bool takes_turns = false);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// One more is finished.
    void advance();
    /// `done` of `total` are finished; the total may have changed.
    void advance_to(std::int64_t done, std::int64_t total);

  private:
    using Clock = std::chrono::steady_clock;
    void draw();
    void draw_openjd() const;
    void reckon(Clock::time_point now);
    /// Draws every second until the object goes.
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
