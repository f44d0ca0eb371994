#pragma once
// Chooses whether a film uses the irradiance cache, and says why.
#include <cstdint>
#include <string>

#include "renderer/renderer.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {

struct CacheChoice {
    renderer::CacheUse use = renderer::CacheUse::off;
    std::string reason;  ///< for the plan's table

    bool keeps() const { return use != renderer::CacheUse::off; }
};

/// `asked`: on, off or auto, which caches where that pays in pictures of `pixels`. `reference`: nothing is cached.
/// `rays`: renderer::Indirect::rays.
CacheChoice choose_cache(const std::string& asked, const scene::Traits& traits, bool rays, bool reference,
                         std::int64_t frames, std::int64_t pixels);

/// For reports: off, on, or static (records live while light stays).
std::string cache_word(const renderer::Settings& rendering);

/// Whether a run with these counts used the cache.
inline bool kept_records(const renderer::Settings& rendering, const renderer::Statistics& found) {
    return rendering.cache == renderer::CacheUse::on || found.cache.created > 0;
}

}  // namespace render2mpeg::app
