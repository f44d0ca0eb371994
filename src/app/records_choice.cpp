#include "app/records_choice.h"

namespace render2mpeg::app {
namespace {

/// Smaller pictures have too few pixels from one edge of light to the next for records to tell of what lies between
/// them. chosen: docs/decisions/0018.
constexpr std::int64_t least_pixels = 160 * 160;

}  // namespace

RecordsChoice choose_records(const std::string& asked, const scene::Traits& traits, bool reference, std::int64_t frames,
                             std::int64_t pixels) {
    if (asked == "off") return {false, "not wanted: --cache off"};
    if (reference) return {false, "no cause: every light point lights every pixel"};
    if (asked == "on") return {true, "--cache on asks for it"};
    if (!traits.has_diffuse_surfaces) return {false, "would not pay: no surface shows one light from all sides"};
    // Where light changes, a sixteenth of all pixels is gathered anew with every frame, and what is near the cause of
    // it as well (docs/decisions/0018: what that comes to).
    if (frames == 1) return {false, "would not pay: there is no later frame to keep light for"};
    if (pixels < least_pixels) return {false, "would not pay: the picture is small"};
    if (traits.lights_change) return {false, "would not pay: lights change"};
    if (traits.objects_move || traits.objects_deform) return {false, "would not pay: what moves changes light"};
    return {true, traits.camera_moves ? "only the camera moves: light stays for later frames"
                                      : "nothing moves: light stays for later frames"};
}

}  // namespace render2mpeg::app
