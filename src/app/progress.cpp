#include "app/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace render2mpeg::app {

Progress::Progress(std::int64_t total, std::int64_t done, bool quiet)
    : total_(total),
      done_(done),
      skipped_(done),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()) {
    if (!quiet_ && terminal_) draw(false);
}

Progress::~Progress() {
    if (drawn_) std::fputs("\n", stderr);
}

void Progress::advance() {
    ++done_;
    if (quiet_) return;
    // chosen: ten redraws a second look alive and cost nothing; a log wants some ten lines a film.
    const bool last = done_ == total_;
    if (terminal_) {
        if (last || Clock::now() - drawn_at_ > std::chrono::milliseconds(100)) draw(last);
    } else if (last || done_ >= next_plain_) {
        draw(last);
        next_plain_ = done_ + std::max<std::int64_t>(1, total_ / 10);
    }
}

void Progress::say(const std::string& line) {
    if (quiet_) return;
    if (drawn_) std::fputs("\r\033[K", stderr);
    std::fputs((line + "\n").c_str(), stderr);
    if (drawn_) draw(false);
}

void Progress::draw(bool last) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const auto rendered = static_cast<double>(done_ - skipped_);
    const double rate = seconds > 0 ? rendered / seconds : 0;
    const double share = total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 1;
    const std::string eta = last       ? "done in " + clock_text(seconds)
                            : rate > 0 ? "ETA " + clock_text(static_cast<double>(total_ - done_) / rate)
                                       : "ETA -";
    std::string line =
        fmt::format("frame {}/{}  {:3.0f} %  {:.2f} frames/s  {}", done_, total_, 100 * share, rate, eta);
    if (terminal_) {
        constexpr int cells = 24;
        const int full = static_cast<int>(std::lround(share * cells));
        line = "\r\033[K[" + std::string(full, '#') + std::string(cells - full, '.') + "] " + line;
        drawn_ = true;
        drawn_at_ = Clock::now();
    } else {
        line += "\n";
    }
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
}

std::string clock_text(double seconds) {
    // chosen: an estimate beyond 100 days says no more than "100 days".
    const auto whole = static_cast<std::int64_t>(std::clamp(std::ceil(seconds), 0.0, 8.64e6));
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

}  // namespace render2mpeg::app
