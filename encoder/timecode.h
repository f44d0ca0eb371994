#pragma once
// Clock times by which editors count a film's pictures.
#include <cstdint>
#include <optional>
#include <string>

#include "encoder/types.h"

namespace render2mpeg::encoder {

/// "01:00:00:00", with `;` before the frames where numbers are dropped.
std::string text_of(const Timecode& time);

/// The inverse, of so many frames per second, rounded to a whole number. `can_drop`: they are 29.97 or 59.94. None
/// where there is no such time.
std::optional<Timecode> timecode_from(const std::string& text, int per_second, bool can_drop);

/// So many frames later, 0 or more; midnight follows 23:59:59.
Timecode later(const Timecode& time, std::int64_t frames, int per_second);

}  // namespace render2mpeg::encoder
