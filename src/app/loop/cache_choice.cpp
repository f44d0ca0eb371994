#include "app/loop/cache_choice.h"

namespace render2mpeg::app {
namespace {

/// In smaller pictures too few pixels lie between edges of light. chosen: docs/measurements.md#irradiance-cache.
constexpr std::int64_t least_pixels = 160 * 160;

}  // namespace

CacheChoice choose_cache(const std::string& asked, const scene::Traits& traits, bool rays, bool reference,
                         std::int64_t frames, std::int64_t pixels) {
    using enum renderer::CacheUse;
    if (asked == "off") return {off, "not wanted: --cache off"};
    if (reference) return {off, "no cause: every pixel is lit by itself"};
    if (asked == "on") return {on, "--cache on asks for it"};
    if (!traits.has_diffuse_surfaces) return {off, "would not pay: no surface shows one light from all sides"};
    if (rays) return {static_light, "pixels and frames share what gather rays found"};
    if (frames == 1) return {off, "would not pay: there is no later frame to keep light for"};
    if (pixels < least_pixels) return {off, "would not pay: the picture is small"};
    // A change of light discards all records: only the frame's own pixels would gain.
    if (traits.lights_change) return {off, "would not pay: lights change"};
    if (traits.changes_light()) return {off, "would not pay: what moves changes light"};
    return {static_light, traits.camera_moves ? "only the camera moves: light stays for later frames"
                                              : "nothing moves: light stays for later frames"};
}

std::string cache_word(const renderer::Settings& rendering) {
    constexpr const char* words[] = {"off", "static", "on"};
    return words[static_cast<int>(rendering.cache)];
}

}  // namespace render2mpeg::app
