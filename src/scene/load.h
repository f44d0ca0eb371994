#pragma once
// Loads a scene of any format.
#include <filesystem>

#include "scene/model/animation.h"
#include "scene/model/load_options.h"

namespace render2mpeg::scene {

/// Loads a film of any format, checks it, and fills in a missing camera or light (Animation::notes). Throws core::Error
/// with file, object and cause.
Animation load(const std::filesystem::path& file, const LoadOptions& options = {});

/// Loads by the name's ending, not completed (preparation/complete.h). Throws core::Error.
Animation load_as_is(const std::filesystem::path& file, const LoadOptions& options);

}  // namespace render2mpeg::scene
