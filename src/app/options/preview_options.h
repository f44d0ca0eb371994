#pragma once
// What options mean for a draft.
#include <cstdint>

#include "app/options/options.h"

namespace render2mpeg::app {

/// Photons that light the anchors of each frame of a draft. chosen: 4 per anchor, of 4 and 8: 0 to 0.1 dB less.
inline constexpr std::uint64_t preview_photons = 4 * 2048;

/// The options of `--preview` with what a draft takes where they say nothing: coarse light, few samples, quick coding
/// (docs/pictures.md). Throws UsageError, naming the option, for what a draft does not have.
RenderOptions preview_options(const RenderOptions& options);

}  // namespace render2mpeg::app
