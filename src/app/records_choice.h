#pragma once

#include <cstdint>
#include <string>

#include "scene/traits.h"

namespace render2mpeg::app {

/// Whether light is kept in records, and why.
struct RecordsChoice {
    bool kept = false;
    std::string reason;  ///< for the plan's table
};

/// `asked`: on, off, or auto, which keeps light where that pays in pictures of so many `pixels`. `reference`: every
/// light point lights every pixel, which leaves nothing to keep.
RecordsChoice choose_records(const std::string& asked, const scene::Traits& traits, bool reference, std::int64_t frames,
                             std::int64_t pixels);

}  // namespace render2mpeg::app
