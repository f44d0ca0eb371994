#include "app/system/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/system/terminal.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

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
    const std::string eta = last ? "done in " + clock_text(s.seconds)
                            : s.per_second > 0
                                ? "ETA " + clock_text(static_cast<double>(s.total - s.done) / s.per_second)
                                : "ETA -";
    // Slow frames are told by their time.
    const std::string rate = s.per_second <= 0 || !s.frames ? ""
                             : s.per_second < 0.5           ? fmt::format("  {:.1f} s/frame", 1 / s.per_second)
                                                            : fmt::format("  {:.2f} frames/s", s.per_second);
    const std::string count = fmt::format("{} {}/{}", core::printable(s.work), s.done, s.total);
    const std::string percent = fmt::format("  {:3.0f} %", 100 * share);

    // Leave out what tells least until it fits; a bar needs ten cells to say anything.
    constexpr int fewest_cells = 10, most_cells = 24;
    for (const std::string& text :
         {count + percent + rate + "  " + eta, count + percent + "  " + eta, count + "  " + eta}) {
        const int left = columns - static_cast<int>(text.size());
        if (left < 0) continue;
        const int cells = std::min(most_cells, left - 3);
        return (with_bar && cells >= fewest_cells ? bar_text(share, cells) : "") + text;
    }
    return fmt::format("{}/{}", s.done, s.total).substr(0, static_cast<std::size_t>(columns));
}

Progress::Progress(std::int64_t total, bool quiet, const std::string& work, Counted counted, double seconds_ago)
    : standing_{work, 0, total, 0, 0, counted != Counted::parts_of_step},
      quiet_(quiet),
      terminal_(can_rewrite_errors()),
      stays_(counted == Counted::frames),
      start_(Clock::now() - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_ago))) {
    if (!quiet_ && terminal_) draw();
}

Progress::~Progress() {
    if (drawn_) std::fputs(stays_ ? "\n" : "\r\033[K", stderr);
}

void Progress::advance() {
    advance_to(standing_.done + 1, standing_.total);
}

void Progress::advance_to(std::int64_t done, std::int64_t total) {
    standing_.done = done;
    standing_.total = total;
    if (quiet_) return;
    standing_.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    standing_.per_second = standing_.seconds > 0 ? static_cast<double>(standing_.done) / standing_.seconds : 0;
    // chosen: ten redraws a second look alive and cost nothing; a log wants some ten lines a film.
    const bool last = standing_.done == standing_.total;
    if (terminal_) {
        if (last || Clock::now() - drawn_at_ > std::chrono::milliseconds(100)) draw();
    } else if (last || standing_.done >= next_plain_) {
        draw();
        next_plain_ = standing_.done + std::max<std::int64_t>(1, standing_.total / 10);
    }
}

void Progress::draw() {
    if (terminal_) {
        // One column stays free: many terminals begin a new line once the last one is taken.
        std::fputs(("\r\033[K" + progress_line(standing_, std::max(20, columns_of_errors() - 1), true)).c_str(),
                   stderr);
        drawn_ = true;
        drawn_at_ = Clock::now();
    } else {
        std::fputs((progress_line(standing_, 1000, false) + "\n").c_str(), stderr);
    }
    std::fflush(stderr);
}

std::string clock_text(double seconds) {
    // chosen: an estimate beyond 100 days says no more than "100 days".
    const auto whole = static_cast<std::int64_t>(std::clamp(std::ceil(seconds), 0.0, 8.64e6));
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

}  // namespace render2mpeg::app
