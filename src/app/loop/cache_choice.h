#pragma once
// Chooses whether a film uses the irradiance cache, and says why.
#include <cstdint>
#include <string>

#include "renderer/renderer.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {

/// Where light is kept, and why.
struct CacheChoice {
    renderer::CacheUse use = renderer::CacheUse::off;
    std::string reason;  ///< for the plan's table

    bool keeps() const { return use != renderer::CacheUse::off; }
};

/// `asked`: on, off, or auto, which keeps light where that pays in pictures of so many `pixels`. `reference`: every
/// light point lights every pixel, which leaves nothing to keep. `rays`: renderer::Indirect::rays.
CacheChoice choose_cache(const std::string& asked, const scene::Traits& traits, bool rays, bool reference,
                         std::int64_t frames, std::int64_t pixels);

/// For reports: off, on, or static, which is on where light stays, or rays gather it.
std::string cache_word(const renderer::Settings& rendering);

/// Whether a run that counted so much kept light.
inline bool kept_records(const renderer::Settings& rendering, const renderer::Statistics& found) {
    return rendering.cache == renderer::CacheUse::on || found.cache.created > 0;
}

}  // namespace render2mpeg::app
