#pragma once

#include <filesystem>
#include <optional>

#include "app/options/options.h"
#include "core/rational.h"
#include "encoder/av/sound.h"

namespace render2mpeg::app {

/// The sound of a film of these frames: that of the options, else `scenes`, the scene's own. Decodes it once, in a
/// probe. Throws core::Error where it cannot be read, or where `output` is a film that cannot have any.
av::Sound sound_of(const CodingOptions& options, const std::optional<std::filesystem::path>& scenes,
                   const std::filesystem::path& output, const FrameRange& frames, const core::FrameRate& rate);

}  // namespace render2mpeg::app
