#pragma once
// When pictures are shown: fields, repeated fields, and what a container and a buffer count.
#include <cstdint>

#include "core/rational.h"
#include "encoder/types.h"

/// When pictures are shown. A field is half of a frame at the declared rate, also where whole frames are shown: the
/// unit in which every picture begins and ends. All functions are of display numbers, so that neither the order of
/// coding nor chunks show in them.
///
/// With low_delay 0, which our streams have, a decoder takes a picture out of its buffer when the one before it in
/// *display* order begins to be shown [H262, C.3.1 and 6.1.1.11]: the picture with coding order c, counted over the
/// film, at the time of number first_number + c - 1. So the buffer fills for fields_of(settings, first_number + c -
/// 1).count fields between the removal of picture c and of picture c + 1.
namespace render2mpeg::encoder {

/// The fields of one picture.
struct ShownFields {
    bool top_first = false;     ///< top_field_first; false where whole frames are shown
    bool repeat_first = false;  ///< repeat_first_field: the first field once more after the second
    int count = 2;
};

/// Rate in the sequence header: the pictures' rate, or with pulldown 5/4 of it (29.97 for 23.976, 30 for 24).
core::FrameRate declared_rate(const Settings& settings);

/// How picture `number` is shown. Fields alternate from picture to picture, beginning with a top field.
ShownFields fields_of(const Settings& settings, std::int64_t number);

/// Fields from the beginning of a cadence to its picture `index`, counted from 0; negative before it.
std::int64_t fields_before(Cadence cadence, std::int64_t index);

}  // namespace render2mpeg::encoder
