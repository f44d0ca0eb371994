#include "encoder/timecode.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <system_error>

namespace render2mpeg::encoder {
namespace {

constexpr std::int64_t minutes_of_day = 24 * 60;

/// Numbers that are left out at the beginning of a minute: 2 of 30, 4 of 60.
int dropped_of(const Timecode& time, int per_second) {
    return time.drops ? per_second / 15 : 0;
}

}  // namespace

std::string text_of(const Timecode& time) {
    std::array<char, 64> text{};
    const int length = std::snprintf(text.data(), text.size(), "%02d:%02d:%02d%c%02d", time.hours, time.minutes,
                                     time.seconds, time.drops ? ';' : ':', time.frames);
    return {text.data(), static_cast<std::size_t>(length)};
}

std::optional<Timecode> timecode_from(const std::string& text, int per_second, bool can_drop) {
    if (text.size() != 11 || text[2] != ':' || text[5] != ':' || (text[8] != ':' && text[8] != ';')) return {};
    Timecode time;
    time.drops = text[8] == ';';
    const std::array<int*, 4> numbers{&time.hours, &time.minutes, &time.seconds, &time.frames};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const char *begin = text.data() + 3 * i, *end = begin + 2;
        const auto read = std::from_chars(begin, end, *numbers[i]);
        if (*begin < '0' || *begin > '9' || read.ec != std::errc{} || read.ptr != end) return {};
    }
    const bool is_time = time.hours < 24 && time.minutes < 60 && time.seconds < 60 && time.frames < per_second;
    if (!is_time || (time.drops && !can_drop)) return {};
    const bool is_dropped = time.minutes % 10 != 0 && time.seconds == 0 && time.frames < dropped_of(time, per_second);
    return is_dropped ? std::nullopt : std::optional(time);
}

Timecode later(const Timecode& time, std::int64_t frames, int per_second) {
    const int dropped = dropped_of(time, per_second);
    const std::int64_t minute = std::int64_t{60} * per_second - dropped, ten = 10 * minute + dropped,
                       day = minutes_of_day / 10 * ten, minutes = std::int64_t{60} * time.hours + time.minutes;
    const std::int64_t before = 60 * minutes * per_second + std::int64_t{time.seconds} * per_second + time.frames -
                                dropped * (minutes - minutes / 10);
    const std::int64_t now = (before + frames) % day, left = now % ten;
    // The first of ten minutes is longer by what it does not leave out.
    const std::int64_t in_ten = std::max<std::int64_t>(0, (left - dropped) / minute);
    const std::int64_t number = now + dropped * (9 * (now / ten) + in_ten), seconds = number / per_second;
    return {static_cast<int>(seconds / 3600 % 24), static_cast<int>(seconds / 60 % 60), static_cast<int>(seconds % 60),
            static_cast<int>(number % per_second), time.drops};
}

}  // namespace render2mpeg::encoder
