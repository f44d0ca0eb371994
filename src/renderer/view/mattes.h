#pragma once
// Mattes of pixels: which objects and materials cover them.
#include "core/mattes.h"
#include "renderer/surface/frame.h"

namespace render2mpeg::renderer {

/// Adds `share` of what covers a sample of the last pixel.
void add_mattes(std::span<const core::Matte> sample, std::uint16_t pixel, float share, std::vector<SeenMatte>& mattes);

/// Takes back what was added of the last pixel.
void forget_mattes(std::uint16_t pixel, std::vector<SeenMatte>& mattes);

/// All of a frame; exposed pixels have their own. Empty where none were looked for.
core::Mattes mattes_of(const Frame& seen);

}  // namespace render2mpeg::renderer
