#pragma once
// Clock times by which editors count a film's pictures.
#include <cstdint>
#include <optional>
#include <string>

namespace render2mpeg::encoder {

/// Clock time of a picture. [SMPTE12]
struct Timecode {
    int hours = 0, minutes = 0, seconds = 0, frames = 0;
    /// At 29.97 and 59.94: each minute but every tenth lacks its first 2 or 4 numbers, so that clocks agree.
    bool drops = false;

    bool operator==(const Timecode&) const = default;
};

/// "01:00:00:00", with `;` before the frames where numbers are dropped.
std::string text_of(const Timecode& time);

/// The inverse, of so many frames per second, rounded to a whole number. `can_drop`: they are 29.97 or 59.94. None
/// where there is no such time.
std::optional<Timecode> timecode_from(const std::string& text, int per_second, bool can_drop);

/// So many frames later, 0 or more; midnight follows 23:59:59.
Timecode later(const Timecode& time, std::int64_t frames, int per_second);

}  // namespace render2mpeg::encoder
