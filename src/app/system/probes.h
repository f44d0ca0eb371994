#pragma once
// Probes of sound and films.
#include <filesystem>

#include "scene/isolation/probe.h"

namespace render2mpeg::app {

/// Decodes sound in a probe. Throws core::Error.
void probe_sound(const std::filesystem::path& file);

scene::ProbeLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
