#include "app/loop/records_choice.h"

namespace render2mpeg::app {
namespace {

/// Smaller pictures have too few pixels from one edge of light to the next for records to tell of what lies between
/// them. chosen: docs/decisions/0018.
constexpr std::int64_t least_pixels = 160 * 160;

}  // namespace

RecordsChoice choose_records(const std::string& asked, const scene::Traits& traits, bool parts, bool reference,
                             std::int64_t frames, std::int64_t pixels) {
    if (asked == "off") return {false, "not wanted: --cache off"};
    if (reference) return {false, "no cause: every light point lights every pixel"};
    if (asked == "on") return {true, "--cache on asks for it"};
    if (!traits.has_diffuse_surfaces) return {false, "would not pay: no surface shows one light from all sides"};
    if (frames == 1) return {false, "would not pay: there is no later frame to keep light for"};
    if (pixels < least_pixels) return {false, "would not pay: the picture is small"};
    // Where light changes as a whole, a sixteenth of all pixels is gathered anew with every frame, and what is near the
    // cause of it as well: that gains less, and loses quality where lamps flash (docs/decisions/0018, "On by
    // itself").
    if (traits.lights_change) return {false, "would not pay: lights change"};
    if (parts)
        return {true, "few things move: light past them stays, unless they hold over a twentieth of its points", false};
    if (traits.changes_light()) return {false, "would not pay: what moves changes light"};
    return {true, traits.camera_moves ? "only the camera moves: light stays for later frames"
                                      : "nothing moves: light stays for later frames"};
}

std::string records_word(const renderer::Settings& rendering) {
    if (!rendering.cache) return "off";
    return rendering.follow ? "on" : "parts";
}

}  // namespace render2mpeg::app
