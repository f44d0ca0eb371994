#include "app/system/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <utility>

#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/numeric.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// Later frames that tell of those to come. chosen: 8, two rounds of B pictures (8, 16, 24:
/// tests/pipeline/pace_test.cpp).
constexpr std::size_t recent = 8;

/// Later frames over those that begin light, where only these are known. chosen: 0.6.
constexpr double later_over_first = 0.6;

}  // namespace

Pace::Pace(std::vector<std::int64_t> firsts, const std::vector<double>& prices) : firsts_(std::move(firsts)) {
    if (prices.empty()) return;
    for (std::vector<double>& sums : sums_) sums.assign(1, 0.0);
    for (std::size_t k = 0; k < prices.size(); ++k) {
        const bool first = is_first(static_cast<std::int64_t>(k));
        sums_[0].push_back(sums_[0].back() + (first ? 0 : prices[k]));
        sums_[1].push_back(sums_[1].back() + (first ? prices[k] : 0));
    }
}

void Pace::add(double seconds) {
    const bool first = is_first(done_);
    const double alike = seconds / prices(done_, done_ + 1, first);
    if (first) {
        first_seconds_ += alike;
        ++first_count_;
    } else {
        recent_.push_back(alike);
        if (recent_.size() > recent) recent_.pop_front();
    }
    ++done_;
}

bool Pace::is_first(std::int64_t frame) const {
    return std::ranges::binary_search(firsts_, frame);
}

double Pace::prices(std::int64_t frame, std::int64_t total, bool of_firsts) const {
    const std::vector<double>& sums = sums_[of_firsts ? 1 : 0];
    if (!sums.empty()) {
        const auto up_to = [&](std::int64_t k) {
            return sums[static_cast<std::size_t>(std::clamp<std::int64_t>(k, 0, std::ssize(sums) - 1))];
        };
        // Frames beyond those that were expected are like the mean.
        const std::int64_t expected = std::ssize(sums) - 1,
                           beyond = std::max<std::int64_t>(0, total - std::max(frame, expected));
        const double mean = (sums_[0].back() + sums_[1].back()) / static_cast<double>(expected);
        return up_to(total) - up_to(frame) + (of_firsts ? 0 : static_cast<double>(beyond) * mean);
    }
    const auto firsts = std::ranges::lower_bound(firsts_, total) - std::ranges::lower_bound(firsts_, frame);
    return static_cast<double>(of_firsts ? firsts : total - frame - firsts);
}

double Pace::later() const {
    return core::divide_or(std::accumulate(recent_.begin(), recent_.end(), 0.0), static_cast<double>(recent_.size()),
                           0.0);
}

std::optional<double> Pace::left(std::int64_t total, double spent) const {
    if (done_ >= total) return 0.0;
    const bool at_first = is_first(done_);
    const double price = prices(done_, done_ + 1, at_first);
    const double known = core::divide_or(first_seconds_, static_cast<double>(first_count_), 0.0);
    // Of a first frame half is done, as likely as not.
    const double first = known > 0 ? known : later() > 0 ? later() : 2 * spent / price;
    if (first <= 0) return {};
    const double rest = later() > 0 ? later() : firsts_.empty() ? first : later_over_first * first;
    const double all = prices(done_, total, true) * first + prices(done_, total, false) * rest;
    // A slow frame is not done at once.
    const double at_hand = price * (at_first ? first : rest);
    return all - at_hand + std::max(at_hand - spent, 0.2 * std::max(at_hand, spent));
}

double Pace::per_second() const {
    return core::divide_or(1.0, later() * prices(done_, done_ + 1, is_first(done_)), 0.0);
}

namespace {

ProgressStyle style = ProgressStyle::line;  ///< set once, before any work
std::mutex activity_mutex;
std::string activity;
std::string activity_now() {
    const std::scoped_lock lock(activity_mutex);
    return activity;
}
std::atomic<bool> has_advanced{false};  ///< any line of this process
std::atomic<int> rewritten_lines{0};    ///< which show the activity themselves

std::string bar_text(double share, int cells) {
    const int full = static_cast<int>(std::lround(share * cells));
    return "[" + std::string(static_cast<std::size_t>(full), '#') +
           std::string(static_cast<std::size_t>(cells - full), '.') + "] ";
}

}  // namespace

std::string progress_line(const Standing& s, int columns, bool with_bar) {
    // A total can turn out to have been too small.
    const double share =
        s.total > 0 ? std::clamp(static_cast<double>(s.done) / static_cast<double>(s.total), 0.0, 1.0) : 1;
    const bool last = s.done >= s.total;
    const std::string time = last     ? "done in " + clock_text(s.seconds)
                             : s.left ? clock_text(s.seconds + *s.left) + " in all, ETA " + clock_text(*s.left)
                                      : clock_text(s.seconds) + " so far, ETA -";
    const std::string rate = s.per_second <= 0 || !s.frames ? ""
                             : s.per_second < 0.5           ? fmt::format("  {:.1f} s/frame", 1 / s.per_second)
                                                            : fmt::format("  {:.2f} frames/s", s.per_second);
    const std::string count = fmt::format("{} {}/{}", core::printable(s.work), s.done, s.total);
    const std::string percent = fmt::format("  {:3.0f} %", 100 * share);

    // Before the first frame, tell the activity.
    const std::string doing = s.done > 0 || s.activity.empty() ? "" : "  " + s.activity;

    // Drop the least telling parts until it fits; a bar needs ten cells.
    constexpr int fewest_cells = 10, most_cells = 24;
    const std::string fitting[] = {fmt::format("{}{}{}{}", count, percent, rate, doing),
                                   fmt::format("{}{}{}", count, percent, doing), fmt::format("{}{}", count, percent),
                                   count};
    for (const std::string& text : fitting) {
        const int left = columns - static_cast<int>(time.size() + 2 + text.size());
        if (left < 0) continue;
        const int cells = std::min(most_cells, left - 3);
        return fmt::format("{}  {}{}", time, with_bar && cells >= fewest_cells ? bar_text(share, cells) : "", text);
    }
    return fmt::format("{}/{}", s.done, s.total).substr(0, static_cast<std::size_t>(columns));
}

std::string progress_json(const Standing& s) {
    std::string work;
    for (const char c : core::printable(s.work))
        work += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    const auto or_null = [](const std::optional<double>& seconds, double more) {
        return seconds ? fmt::format("{:.3f}", *seconds + more) : std::string("null");
    };
    return fmt::format(R"({{"work":"{}","done":{},"total":{},"seconds":{:.3f},"left":{},"whole":{},"activity":"{}"}})",
                       work, s.done, s.total, s.seconds, or_null(s.left, 0), or_null(s.left, s.seconds), s.activity);
}

ProgressStyle progress_style_from(const std::string& name) {
    for (const auto& [known, wanted] : {std::pair{"minute", ProgressStyle::minute},
                                        {"json", ProgressStyle::json},
                                        {"openjd", ProgressStyle::openjd},
                                        {"none", ProgressStyle::none}})
        if (name == known) return wanted;
    return ProgressStyle::line;
}

void tell_activity(std::string words) {
    const std::scoped_lock lock(activity_mutex);
    activity = std::move(words);
}

std::jthread every(std::chrono::seconds pause, std::function<void()> tick) {
    return std::jthread([pause, tick = std::move(tick)](const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any ends;
        std::unique_lock lock(mutex);
        while (!ends.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) tick();
    });
}

bool shows_words() {
    return style == ProgressStyle::line || style == ProgressStyle::minute;
}

std::jthread tell_activities(bool quiet) {
    if (quiet || !shows_words()) return {};
    return every(std::chrono::seconds(1), [told = std::string(), seconds = 0, since = 0]() mutable {
        // chosen: 10 s in logs, where a refusal is to stand alone, in one line; not tuned.
        const int first = can_rewrite_errors() ? 1 : 10;
        constexpr int again = 60;
        const std::string now = activity_now();
        ++seconds;
        if (seconds < first || now.empty() || has_advanced || rewritten_lines > 0) return;
        if (now == told && ++since < again) return;
        print_line(fmt::format("{} {}", clock_text(seconds), now));
        told = now;
        since = 0;
    });
}

void show_progress_as(ProgressStyle wanted) {
    style = wanted;
}

bool shows_steps() {
    return style == ProgressStyle::json || (style == ProgressStyle::line && can_rewrite_errors());
}

Progress::Progress(std::int64_t total, bool quiet, const std::string& work, Counted counted, double seconds_ago,
                   Pace pace)
    : standing_{work, 0, total, 0, seconds_ago, counted != Counted::parts_of_step, {}, ""},
      pace_(std::move(pace)),
      quiet_(quiet || style == ProgressStyle::none),
      terminal_(style == ProgressStyle::line && can_rewrite_errors()),
      stays_(counted == Counted::frames),
      json_(style == ProgressStyle::json),
      timed_(style == ProgressStyle::minute || style == ProgressStyle::openjd),
      before_(seconds_ago),
      start_(Clock::now()),
      advanced_at_(start_) {
    if (quiet_) return;
    rewritten_lines += terminal_ ? 1 : 0;
    if (!terminal_ && !json_ && !timed_) return;
    draw();
    ticker_ = every(std::chrono::seconds(timed_ ? 60 : 1), [this] { tick(); });
}

Progress::~Progress() {
    ticker_ = {};
    rewritten_lines -= terminal_ && !quiet_ ? 1 : 0;
    if (drawn_) std::fputs(stays_ ? "\n" : "\r\033[K", stderr);
}

void Progress::tick() {
    const std::lock_guard lock(mutex_);
    reckon(Clock::now());
    if (standing_.done < standing_.total) draw();
}

void Progress::reckon(Clock::time_point now) {
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    standing_.seconds = before_ + seconds(now - start_);
    standing_.left = pace_.left(standing_.total, seconds(now - advanced_at_));
    standing_.per_second = pace_.per_second();
    standing_.activity = standing_.frames ? activity_now() : "";
}

void Progress::advance() {
    advance_to(standing_.done + 1, standing_.total);
}

void Progress::advance_to(std::int64_t done, std::int64_t total) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    const std::int64_t more = done - standing_.done;
    const double took = std::chrono::duration<double>(now - advanced_at_).count();
    // Several at once were done earlier, or are parts with a share each.
    if (more > 1 && standing_.frames)
        pace_.skip(more);
    else
        for (std::int64_t i = 0; i < more; ++i)
            // Time before the film's first frame counts apart.
            pace_.add((took + (standing_.done == 0 && !standing_.frames ? before_ : 0)) / static_cast<double>(more));
    advanced_at_ = now;
    has_advanced = true;
    standing_.done = done;
    standing_.total = total;
    if (quiet_) return;
    reckon(now);
    // chosen: ten redraws a second look alive and cost nothing; a log wants some ten lines a film.
    const bool last = standing_.done == standing_.total;
    if (terminal_) {
        if (last || now - drawn_at_ > std::chrono::milliseconds(100)) draw();
    } else if (timed_) {
        // chosen: OpenJD's monitors show it live, and each line costs them a message.
        const bool live = style == ProgressStyle::openjd && now - drawn_at_ > std::chrono::seconds(5);
        if (last || live) draw();
    } else if (json_ || last || standing_.done >= next_plain_) {
        draw();
        next_plain_ = standing_.done + std::max<std::int64_t>(1, standing_.total / 10);
    }
}

void Progress::draw_openjd() const {
    // A step is a status alone, else the bar would restart.
    const double share =
        static_cast<double>(standing_.done) / static_cast<double>(std::max<std::int64_t>(1, standing_.total));
    if (stays_) fmt::print("openjd_progress: {:.1f}\n", 100 * std::clamp(share, 0.0, 1.0));
    fmt::print("openjd_status: {}\n", progress_line(standing_, 1000, false));
    std::fflush(stdout);
}

void Progress::draw() {
    if (style == ProgressStyle::openjd) {
        draw_openjd();
        drawn_at_ = Clock::now();
    } else if (json_) {
        std::fputs((progress_json(standing_) + "\n").c_str(), stderr);
    } else if (terminal_) {
        // Many terminals wrap at the last column.
        std::fputs(("\r\033[K" + progress_line(standing_, std::max(20, columns_of_errors() - 1), true)).c_str(),
                   stderr);
        drawn_ = true;
        drawn_at_ = Clock::now();
    } else {
        std::fputs((progress_line(standing_, 1000, false) + "\n").c_str(), stderr);
    }
    std::fflush(stderr);
}

std::function<bool()> advancing(Progress& progress) {
    return [&progress] {
        progress.advance();
        return !InterruptGuard::requested();
    };
}

std::string clock_text(double seconds) {
    // chosen: an estimate beyond 100 days says no more than "100 days".
    const auto whole = static_cast<std::int64_t>(std::clamp(std::ceil(seconds), 0.0, 8.64e6));
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

}  // namespace render2mpeg::app
