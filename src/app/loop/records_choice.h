#pragma once

#include <cstdint>
#include <string>

#include "renderer/renderer.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {

/// Whether light is kept in records, and why.
struct RecordsChoice {
    bool kept = false;
    std::string reason;  ///< for the plan's table
    bool follow = true;  ///< kept: also if light changes as a whole (renderer::Settings::follow)
};

/// `asked`: on, off, or auto, which keeps light where that pays in pictures of so many `pixels`. `reference`: every
/// light point lights every pixel, which leaves nothing to keep. `parts`: light may be worth parting
/// (renderer::LightParts::may_suit).
RecordsChoice choose_records(const std::string& asked, const scene::Traits& traits, bool parts, bool reference,
                             std::int64_t frames, std::int64_t pixels);

/// For reports: off, on, or parts, which is on if light can be parted.
std::string records_word(const renderer::Settings& rendering);

/// Whether a run that counted so much kept light: whether it can be parted is known once its light points are.
inline bool kept_records(const renderer::Settings& rendering, const renderer::Statistics& found) {
    return rendering.cache && (rendering.follow || found.records_created > 0);
}

}  // namespace render2mpeg::app
